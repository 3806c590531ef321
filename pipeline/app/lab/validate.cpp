#include "pipeline/app/lab/lab.h"

#include <algorithm>
#include <memory>
#include <string>

#include "base/files/shipped.h"
#include "base/parallel/for_each.h"
#include "base/progress.h"
#include "pipeline/inspect/vehicle_report.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/soils.h"
#include "pipeline/lab/validate/vehicles.h"

namespace gonogo::app {
namespace {

/// Makes the figures, writes each to `folder` unless that is empty, and prints their checks. Throws DeviceError with
/// the number of checks of `what` ("soils") that do not hold, if any.
void report_figures(const Globals& globals, const std::vector<std::string>& names, const std::string& folder,
                    const std::string& what, const std::function<lab::CheckFigure(const std::string&)>& make) {
  Json json = Json::object(), checks = Json::object();
  std::string text;
  int failed = 0;
  for (const std::string& name : names) {
    stop_if_cancelled();
    const lab::CheckFigure figure = make(name);
    if (!folder.empty()) lab::write_figure(folder, figure);
    text += lab::as_text(figure);
    for (const lab::BoundedNumber& c : figure.check) {
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
    const vehicle::Vehicle v = vehicle::read_vehicle(inspect::vehicle_file(name));
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
  add_named(*vehicles, "vehicles", request->vehicles, kVehicle, "Vehicles")->capture_default_str();
  add_named(*vehicles, "--out", request->folder, kFolder, "Folder for a figure and a table of every kind of check");
  vehicles->add_flag("--gpu", request->gpu, "Run on the GPU");
  add_examples(*vehicles, {"gonogo validate vehicles --out docs/validation --json"});
  vehicles->callback([&globals, request] { validate_vehicles(globals, *request); });
}

struct SoilsRequest {
  std::vector<std::string> figures;
  std::string folder;
  lab::SoilValidation tests;
};

void validate_soils(const Globals& globals, SoilsRequest& request) {
  request.tests.threads = threads_or_all(globals.threads);
  report_figures(globals, request.figures, request.folder, "soils",
                 [&](const std::string& name) { return lab::soil_figure(name, request.tests); });
}

void add_soils_check(CLI::App& validate, const Globals& globals) {
  CLI::App* soils =
      validate.add_subcommand("soils", "Soil tests, and soils through the calibration; fails when a bound is not kept");
  auto request = std::make_shared<SoilsRequest>();
  request->figures = lab::soil_figures();
  const std::vector<std::string> all = request->figures;
  auto calibration = std::make_shared<std::string>("calibration_90mm");
  auto seeds = std::make_shared<int>(2);
  soils->add_option("figures", request->figures, "Figures to make; default: all")->check(CLI::IsMember(all));
  add_named(*soils, "--calibration", *calibration, kTable, "Table of the grains to be tested")->capture_default_str();
  add_number(*soils, "--seeds", *seeds, {1, 100}, "Beds for each test");
  soils->add_flag("--quick", request->tests.quick, "Smaller beds and shorter paths, for a first look");
  add_named(*soils, "--out", request->folder, kFolder, "Folder for a figure and a table of each");
  add_examples(*soils, {"gonogo validate soils shear triaxial --out docs/validation --json"});
  soils->callback([&globals, request, calibration, seeds] {
    request->tests.calibration = shipped_file("soils", "calibration", *calibration);
    request->tests.seeds = *seeds;
    validate_soils(globals, *request);
  });
}

struct ElasticRequest {
  std::vector<std::string> figures = lab::elastic_figures();
  std::string folder;
};

void validate_elastic(const Globals& globals, const ElasticRequest& request) {
  report_figures(globals, request.figures, request.folder, "elastic bodies", lab::elastic_figure);
}

void add_elastic_check(CLI::App& validate, const Globals& globals) {
  CLI::App* elastic = validate.add_subcommand(
      "elastic",
      "Elastic bodies in compliant contact against closed forms and two benchmarks; fails when one does not hold");
  auto request = std::make_shared<ElasticRequest>();
  elastic->add_option("figures", request->figures, "Figures to make; default: all")
      ->check(CLI::IsMember(lab::elastic_figures()));
  add_named(*elastic, "--out", request->folder, kFolder, "Folder for a picture and a table of each");
  add_examples(*elastic, {"gonogo validate elastic --out out/elastic", "gonogo validate elastic hertz mindlin --json"});
  elastic->callback([&globals, request] { validate_elastic(globals, *request); });
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
