// Tables of commands and their options, for CLI11. Each command has a file of its own with one add_ function. Callbacks
// throw InputError, DeviceError or Cancelled, and main() turns them into one sentence and an exit code.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/app/work/work.h"

namespace gonogo::app {

/// Work of a command that needs LibTorch or GDAL. commands.cpp.in says which program does it.
template <class Options>
using Work = std::function<void(const Globals&, const Options&)>;

// Names of values in help, the man page and completions, by which they are completed (complete.h).
inline constexpr const char* kFile = "FILE";
inline constexpr const char* kFolder = "FOLDER";
inline constexpr const char* kModel = "MODEL";              // file, or name of one in data
inline constexpr const char* kStudy = "STUDY";              // file
inline constexpr const char* kVehicle = "VEHICLE";          // file, or name of one in configs/vehicles
inline constexpr const char* kSoil = "SOIL";                // file, or name of one in configs/soils
inline constexpr const char* kTable = "TABLE";              // calibration: file, or name of one in configs/soils
inline constexpr const char* kBenchmark = "BENCHMARK";      // file, or name of one in configs/benchmarks
inline constexpr const char* kVariable = "VARIABLE";        // of the contract, or a measure
inline constexpr const char* kSetting = "VARIABLE=NUMBER";  // of the contract
inline constexpr const char* kCommand = "COMMAND";          // of this program

/// Seeds are unsigned, and CLI11 takes -1 for the greatest.
inline const CLI::Validator kSeed(
    [](std::string& text) -> std::string {
      return !text.empty() && text.front() == '-' ? text + " is given; 0 or a positive whole number is possible" : "";
    },
    "");

/// "{a,b,c}": the name of a value that is one of a few words.
std::string one_of(const std::vector<std::string>& words);

/// Ends the help of a command by a note, where there is one, and command lines; each command has at least one. A line
/// may continue after a backslash, indented by six blanks, and end with two blanks and a remark after #.
void add_examples(CLI::App& command, const std::vector<std::string>& lines, const std::string& note = "");

/// All commands (commands.cpp.in).
void add_commands(CLI::App& app, const Globals& globals);

void add_run_command(CLI::App& app, const Globals& globals, const Work<RunRequest>& work);
void add_design_command(CLI::App& app, const Globals& globals, const Work<DesignOptions>& with_region);
void add_simulate_command(CLI::App& app, const Globals& globals);
void add_original_command(CLI::App& app, const Globals& globals);
void add_campaign_command(CLI::App& app, const Globals& globals, const Work<ActiveOptions>& active);
void add_dataset_command(CLI::App& app, const Globals& globals);
void add_soil_command(CLI::App& app, const Globals& globals);
void add_vehicle_command(CLI::App& app, const Globals& globals);
void add_train_command(CLI::App& app, const Globals& globals, const Work<TrainOptions>& work);
void add_evaluate_command(CLI::App& app, const Globals& globals, const Work<EvaluateOptions>& work);
void add_learning_curve_command(CLI::App& app, const Globals& globals, const Work<LearningCurveOptions>& work);
void add_capacity_command(CLI::App& app, const Globals& globals, const Work<CapacityOptions>& work);
void add_infer_command(CLI::App& app, const Globals& globals);
void add_sample_command(CLI::App& app, const Globals& globals);
void add_qubo_command(CLI::App& app, const Globals& globals);
void add_models_command(CLI::App& app, const Globals& globals);
void add_map_command(CLI::App& app, const Globals& globals, const Work<map::MapFiles>& work);
void add_region_command(CLI::App& app, const Globals& globals, const Work<map::RegionMakeRequest>& make);
void add_route_command(CLI::App& app, const Globals& globals, const Work<RouteOptions>& work);
void add_compare_command(CLI::App& app, const Globals& globals, const Work<map::CompareRequest>& work);
void add_view_command(CLI::App& app, const Globals& globals, const Work<ViewOptions>& work);
void add_mesh_command(CLI::App& app, const Globals& globals);
void add_bench_command(CLI::App& app, const Globals& globals);
void add_validate_command(CLI::App& app, const Globals& globals);
void add_doctor_command(CLI::App& app, const Globals& globals);
void add_help_command(CLI::App& app, const Globals& globals);
void add_completion_command(CLI::App& app, const Globals& globals);
void add_man_command(CLI::App& app, const Globals& globals);

}  // namespace gonogo::app
