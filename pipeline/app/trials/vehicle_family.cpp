// gonogo vehicle numbers, model and study: a vehicle's place in the family, what the family says of it, and a study of
// trials for it.
#include <filesystem>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/files/file.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "base/shell.h"
#include "base/units.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/app/trials/vehicle_commands.h"
#include "pipeline/campaign/setup/vehicle_study.h"
#include "pipeline/inspect/vehicle_report.h"
#include "pipeline/map/family_answers.h"
#include "vehicle/family/driveline_share.h"
#include "vehicle/family/vehicle_numbers.h"

namespace gonogo::app {
namespace {

struct NumbersOptions {
  std::string vehicle;
  double gravity = kGravity;
};

void show_numbers(const Globals& globals, const NumbersOptions& o) {
  const vehicle::Family family = vehicle::read_family(Config::read(shipped_file("families", "family", "wheeled")));
  const vehicle::Vehicle v = vehicle::read_vehicle(inspect::vehicle_file(o.vehicle));
  const vehicle::VehicleNumbers numbers = vehicle::vehicle_numbers(v, o.gravity);
  Json list = Json::array();
  std::string text = v.name + line(", gravity %.3g m/s2; lengths over the wheel's diameter\n\n", o.gravity) +
                     "number                    value  family's range     place\n";
  std::size_t outside = 0;
  for (const vehicle::PlacedNumber& n : vehicle::placed(family, numbers)) {
    vehicle::PlacedNumber asked = n;
    asked.value = vehicle::counted(n);
    outside += vehicle::excess(asked) > 0;
    const std::string ends = asked.value != n.value ? line(", counts as %.3g", asked.value) : "";
    text += line("%-20s %10.3g  %7.3g to %-7.3g  %-25s %s\n", n.name.c_str(), n.value, n.range.minimum, n.range.maximum,
                 (vehicle::place_text(n) + ends).c_str(), n.about.c_str());
    list.push_back(Json::Object{{"name", n.name},
                                {"value", n.value},
                                {"range", Json::Array{n.range.minimum, n.range.maximum}},
                                {"counts_as", asked.value},
                                {"inside", vehicle::excess(asked) == 0},
                                {"outside_share", vehicle::excess(asked)}});
  }
  text += outside == 0 ? "\nthe vehicle lies inside the family\n"
                       : "\nthe vehicle lies outside the family in " + std::to_string(outside) + " of its numbers\n";
  constexpr double kShown = 20;  // [deg]
  const double felt = to_degrees(vehicle::felt_slope(v, numbers, to_radians(kShown)));
  text +=
      felt - kShown < 0.05
          ? "uphill its driveline lets every wheel pull as its load does\n"
          : line("uphill its driveline makes %g degrees as hard as %.1f with a motor in every wheel\n", kShown, felt);
  Json result = Json::object();
  result["uphill_20_degrees_feels_deg"] = felt;
  result["vehicle"] = v.name;
  result["gravity_m_per_s2"] = o.gravity;
  result["numbers"] = list;
  result["inside"] = outside == 0;
  print_result(globals, result, text);
}

struct StudyOptions {
  std::string vehicle, out;
  int points = 600;
  double gravity = kGravity;
};

void write_study(const Globals& globals, const StudyOptions& o) {
  const std::filesystem::path vehicle = inspect::vehicle_file(o.vehicle);
  const std::filesystem::path out = o.out.empty() ? vehicle.stem().string() + "_study.json" : o.out;
  if (std::filesystem::exists(out))
    throw InputError(out.string() + ": exists already, and is kept; give another file with --out, or remove it");
  const campaign::VehicleStudy study = campaign::study_of_vehicle(vehicle, std::size_t(o.points), o.gravity);
  write_file_atomically(out, study.json.dump(2) + "\n");
  const campaign::StudyCost cost = campaign::cost_of(study, std::size_t(o.points));
  Json result = Json::object();
  result["file"] = out.string();
  result["trials"] = o.points;
  result["seconds"] = cost.seconds;
  result["device"] = cost.device;
  result["grains_per_tread"] = study.grains_per_tread;
  const std::string folder = "out/" + vehicle.stem().string();
  print_result(globals, result,
               "written to " + out.string() + "\n" + campaign::cost_text(study, std::size_t(o.points)) +
                   line("\ngrains of %.3g mm, %.2g across a tread, about %.0f in a bed\n", 1e3 * study.grain,
                        study.grains_per_tread, study.grains) +
                   "next\n  gonogo campaign run " + shell_word(out.string()) + " --out " + shell_word(folder) +
                   "\n  gonogo train --dataset " + shell_word(folder + "/dataset.h5") + " --study " +
                   shell_word(out.string()) + " --out " + shell_word(folder + "/model.h5") + "\n  gonogo map --model " +
                   shell_word(folder + "/model.h5") + " --dem elevation.tif --out out/map\n");
}

struct ModelOptions {
  std::string vehicle, family;  // family: empty for the one that ships
  std::filesystem::path out;
  double gravity = kGravity;
};

void write_model(const Globals& globals, const ModelOptions& o) {
  const vehicle::Vehicle v = vehicle::read_vehicle(inspect::vehicle_file(o.vehicle));
  const learning::Model model = map::model_for_vehicle(o.family, v, o.gravity);
  learning::write_model(o.out, model);
  Json result = Json::object();
  result["file"] = o.out.string();
  result["vehicle"] = v.name;
  const std::string file = shell_word(o.out.string());
  print_result(globals, result,
               "written to " + o.out.string() + ": what the family says of " + v.name +
                   ", without a trial of its own\n" + "next\n  gonogo infer --model " + file +
                   " --set slope_along=12 friction_angle=33\n  gonogo sample --model " + file +
                   " --rows 1000 --out rows.csv\n  gonogo qubo export --model " + file + " --out problem.json\n");
}

template <class Options>
void add_gravity(CLI::App& command, Options& options) {
  add_number(command, "--gravity", options.gravity, {0.1, 30.0}, "Gravity where it drives [m/s2]");
}

}  // namespace

void add_vehicle_numbers(CLI::App& vehicle, const Globals& globals) {
  CLI::App* command =
      vehicle.add_subcommand("numbers", "Numbers without dimension, and whether the family covers them");
  const auto options = std::make_shared<NumbersOptions>();
  add_named(*command, "vehicle", options->vehicle, kVehicle, "Vehicle")->required();
  add_gravity(*command, *options);
  add_examples(*command, {"gonogo vehicle numbers hmmwv", "gonogo vehicle numbers viper --gravity 1.62"});
  command->callback([&globals, options] { show_numbers(globals, *options); });
}

void add_vehicle_model(CLI::App& vehicle, const Globals& globals) {
  CLI::App* command = vehicle.add_subcommand(
      "model", "Write a model of the vehicle that its family's teacher taught, to infer, sample and anneal");
  const auto options = std::make_shared<ModelOptions>();
  add_named(*command, "vehicle", options->vehicle, kVehicle, "Vehicle")->required();
  add_gravity(*command, *options);
  add_named(*command, "--family-model", options->family, kModel, "Model of its family; by default the one that ships");
  add_named(*command, "--out", options->out, kFile, "Model file to write")->required();
  add_examples(*command, {"gonogo vehicle model buggy.json --out out/buggy.h5",
                          "gonogo vehicle model viper --gravity 1.62 --out out/viper.h5"});
  command->callback([&globals, options] { write_model(globals, *options); });
}

void add_vehicle_study(CLI::App& vehicle, const Globals& globals) {
  CLI::App* command =
      vehicle.add_subcommand("study", "Write a study of trials for a vehicle, and say what it costs here");
  const auto options = std::make_shared<StudyOptions>();
  add_named(*command, "vehicle", options->vehicle, kVehicle, "Vehicle")->required();
  add_number(*command, "--points", options->points, {8, 1000000}, "Points of the design");
  add_gravity(*command, *options);
  add_named(*command, "--out", options->out, kFile, "Study file; by default NAME_study.json");
  add_examples(*command, {"gonogo vehicle study buggy.json --points 600"});
  command->callback([&globals, options] { write_study(globals, *options); });
}

}  // namespace gonogo::app
