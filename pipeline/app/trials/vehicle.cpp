#include <memory>
#include <string>

#include "pipeline/app/cli/command.h"
#include "pipeline/app/trials/vehicle_commands.h"
#include "pipeline/inspect/feasible_report.h"
#include "pipeline/inspect/vehicle_report.h"

namespace gonogo::app {
namespace {

std::shared_ptr<std::string> add_name(CLI::App& command) {
  auto name = std::make_shared<std::string>();
  add_named(command, "vehicle", *name, kVehicle, "Vehicle")->required();
  return name;
}

void add_show(CLI::App& vehicle, const Globals& globals) {
  CLI::App* command = vehicle.add_subcommand("show", "Masses, static wheel loads, contact pressures, gears, sources");
  const auto name = add_name(*command);
  add_examples(*command, {"gonogo vehicle show hmmwv"});
  command->callback([&globals, name] {
    const inspect::Report r = inspect::show_vehicle(vehicle::read_vehicle(inspect::vehicle_file(*name)));
    print_result(globals, r.json, r.text);
  });
}

void add_feasible(CLI::App& vehicle, const Globals& globals) {
  CLI::App* command = vehicle.add_subcommand(
      "feasible", "Whether torques in their limits and forces in friction cones hold or move it on hard ground");
  const auto name = add_name(*command);
  const auto request = std::make_shared<inspect::FeasibleRequest>();
  command->add_option("--slope", request->slope_along, "Slope along, uphill positive [deg]")->capture_default_str();
  command->add_option("--cross-slope", request->slope_across, "Slope across, left side higher positive [deg]")
      ->capture_default_str();
  command->add_option("--step", request->step, "Height of a step to climb [m]")->capture_default_str();
  command->add_option("--mu", request->friction, "Friction coefficient of the wheels")->capture_default_str();
  command
      ->add_option("--edge-distance", request->edge_distance,
                   "Least distance of the centre of pressure from the edge of the wheels' polygon, on a plane [m]")
      ->capture_default_str();
  const auto forces = std::make_shared<std::string>();
  add_named(*command, "--forces", *forces, kFile,
            "Measured wheel forces (JSON): the nearest forces that it can have, in place of what limits it");
  add_examples(*command, {"gonogo vehicle feasible hmmwv --slope 20 --cross-slope 10 --mu 0.6",
                          "gonogo vehicle feasible hmmwv --slope 10 --forces forces.json"});
  command->callback([&globals, name, request, forces] {
    const vehicle::Vehicle v = vehicle::read_vehicle(inspect::vehicle_file(*name));
    const inspect::Report r =
        forces->empty() ? inspect::check_feasible(v, *request) : inspect::fit_measured_forces(v, *request, *forces);
    print_result(globals, r.json, r.text);
  });
}

void add_vci(CLI::App& vehicle, const Globals& globals) {
  CLI::App* command = vehicle.add_subcommand(
      "vci", "Mobility index, vehicle cone index for one and fifty passes, semi-empirical traction");
  const auto name = add_name(*command);
  add_examples(*command, {"gonogo vehicle vci hmmwv"});
  command->callback([&globals, name] {
    const inspect::Report r = inspect::vehicle_cone_index(vehicle::read_vehicle(inspect::vehicle_file(*name)));
    print_result(globals, r.json, r.text);
  });
}

}  // namespace

void add_vehicle_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("vehicle", "Make a vehicle, its facts, and what it can do at best");
  command->require_subcommand(1);
  add_examples(*command, {"gonogo vehicle show hmmwv"});
  add_vehicle_new(*command, globals);
  add_show(*command, globals);
  add_feasible(*command, globals);
  add_vci(*command, globals);
  add_vehicle_numbers(*command, globals);
  add_vehicle_model(*command, globals);
  add_vehicle_study(*command, globals);
}

}  // namespace gonogo::app
