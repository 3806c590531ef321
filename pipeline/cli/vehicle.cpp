#include <memory>
#include <string>

#include "pipeline/cli/command.h"
#include "pipeline/vehicle/locate.h"
#include "pipeline/vehicle/show.h"

namespace gonogo::pipeline::cli {
namespace {

std::shared_ptr<std::string> add_name(CLI::App& command) {
  auto name = std::make_shared<std::string>();
  command.add_option("vehicle", *name, "Vehicle file, or the name of one in configs/vehicles")->required();
  return name;
}

void add_show(CLI::App& vehicle, const Globals& globals) {
  CLI::App* command = vehicle.add_subcommand("show", "Masses, static wheel loads, contact pressures, gears, sources");
  const auto name = add_name(*command);
  command->footer("Example:\n  gonogo vehicle show hmmwv");
  command->callback([&globals, name] {
    const Report r = show_vehicle(vehicle::read_vehicle(vehicle_file(*name)));
    print_result(globals, r.json, r.text);
  });
}

}  // namespace

void add_vehicle_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("vehicle", "What a vehicle is and what it can do at best");
  command->require_subcommand(1);
  command->footer("Example:\n  gonogo vehicle show hmmwv");
  add_show(*command, globals);
}

}  // namespace gonogo::pipeline::cli
