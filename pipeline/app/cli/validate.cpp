#include <algorithm>
#include <memory>
#include <string>

#include "base/cancel.h"
#include "base/cores.h"
#include "pipeline/app/cli/validate_parts.h"
#include "pipeline/lab/validate/vehicles.h"
#include "pipeline/lab/vehicle/locate.h"

namespace gonogo::app {

void report_figures(const Globals& globals, const std::vector<std::string>& names, const std::string& folder,
                    const std::string& what, const std::function<lab::SoilFigure(const std::string&)>& make) {
  Json json = Json::object(), checks = Json::object();
  std::string text;
  int failed = 0;
  for (const std::string& name : names) {
    stop_if_cancelled();
    const lab::SoilFigure figure = make(name);
    if (!folder.empty()) lab::write_figure(folder, figure);
    text += lab::as_text(figure);
    for (const lab::SoilCheck& c : figure.check) {
      json[c.key] = c.measured;
      failed += !c.holds();
    }
    checks[name] = lab::as_json(figure);
  }
  json["failed"] = failed;
  json["checks"] = checks;
  if (failed > 0)
    fail_with_result(globals, json, text, DeviceError(std::to_string(failed) + " checks of " + what + " do not hold"));
  print_result(globals, json, text);
}

namespace {

struct VehiclesRequest {
  std::vector<std::string> vehicles{"hmmwv"};
  std::string folder;
  bool gpu = false;
};

void validate_vehicles(const Globals& globals, const VehiclesRequest& request) {
  const vehicle::HardGroundRun run{request.gpu ? sim::Backend::cuda : sim::Backend::cpu,
                                   threads_or_all(globals.threads)};
  Json json;
  std::string text;
  int failed = 0;
  for (const std::string& name : request.vehicles) {
    const vehicle::Vehicle v = vehicle::read_vehicle(lab::vehicle_file(name));
    const auto reports = lab::check_on_hard_ground(v, run);
    if (!request.folder.empty()) lab::write_reports(request.folder, v.name, reports);
    json[v.name] = lab::as_json(reports);
    text += v.name + "\n" + lab::as_text(reports);
    failed += lab::failures(reports);
  }
  json["failed"] = failed;
  if (failed > 0) {
    const std::string fault = std::to_string(failed) + " checks of vehicles on hard ground do not hold";
    fail_with_result(globals, json, text, DeviceError(fault));
  }
  print_result(globals, json, text);
}

void add_vehicles(CLI::App& command, const Globals& globals) {
  CLI::App* vehicles = command.add_subcommand(
      "vehicles", "Whole vehicles on hard ground against closed forms; fails when one does not hold");
  auto request = std::make_shared<VehiclesRequest>();
  vehicles->add_option("vehicles", request->vehicles, "Vehicles")->type_name(kVehicle)->capture_default_str();
  vehicles->add_option("--out", request->folder, "Folder for a figure and a table of every kind of check")
      ->type_name(kFolder);
  vehicles->add_flag("--gpu", request->gpu, "Run on the GPU");
  add_examples(*vehicles, {"gonogo validate vehicles --out docs/validation --json"});
  vehicles->callback([&globals, request] { validate_vehicles(globals, *request); });
}

}  // namespace

void add_validate_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("validate", "Checks against what others published and closed forms");
  command->require_subcommand(1);
  add_examples(*command, {"gonogo validate fclib tests/data/fclib"});
  add_vehicles(*command, globals);
  add_soils_check(*command, globals);
  add_wheels_check(*command, globals);
  add_trial_checks(*command, globals);
  add_fclib_check(*command, globals);
  add_elastic_check(*command, globals);
}

}  // namespace gonogo::app
