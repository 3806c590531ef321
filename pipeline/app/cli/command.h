// Commands of the program. Each lives in its own file and registers itself with one add_ function; callbacks throw
// InputError, DeviceError or Cancelled, and main() turns them into one sentence and an exit code.
#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include "base/json/json.h"

namespace gonogo::app {

/// Options shared by all commands, filled while parsing, read inside callbacks.
struct Globals {
  bool json = false;  // machine-readable result as the last line of stdout; everything else goes to stderr
  int threads = 0;    // 0: all cores
};

/// Prints the result of a command: one JSON line under --json, otherwise `text` for people.
void print_result(const Globals& globals, const Json& result, const std::string& text);

/// All commands of this build, in the order of pipeline/cli/CMakeLists.txt (generated there).
void add_commands(CLI::App& app, const Globals& globals);

/// A command whose room was left out at build time: says which option brings it in, as InputError.
void add_left_out_command(CLI::App& app, const std::string& name, const std::string& option);

void add_run_command(CLI::App& app, const Globals& globals);
void add_design_command(CLI::App& app, const Globals& globals);
void add_simulate_command(CLI::App& app, const Globals& globals);
void add_campaign_command(CLI::App& app, const Globals& globals);
void add_dataset_command(CLI::App& app, const Globals& globals);
void add_soil_command(CLI::App& app, const Globals& globals);
void add_vehicle_command(CLI::App& app, const Globals& globals);
void add_original_command(CLI::App& app, const Globals& globals);
void add_train_command(CLI::App& app, const Globals& globals);
void add_evaluate_command(CLI::App& app, const Globals& globals);
void add_capacity_command(CLI::App& app, const Globals& globals);
void add_infer_command(CLI::App& app, const Globals& globals);
void add_qubo_command(CLI::App& app, const Globals& globals);
void add_compare_command(CLI::App& app, const Globals& globals);
void add_view_command(CLI::App& app, const Globals& globals);
void add_map_command(CLI::App& app, const Globals& globals);
void add_route_command(CLI::App& app, const Globals& globals);
void add_mesh_command(CLI::App& app, const Globals& globals);
void add_bench_command(CLI::App& app, const Globals& globals);
void add_validate_command(CLI::App& app, const Globals& globals);
void add_doctor_command(CLI::App& app, const Globals& globals);

}  // namespace gonogo::app
