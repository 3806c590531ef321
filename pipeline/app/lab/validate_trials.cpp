#include <algorithm>
#include <memory>
#include <string>

#include "base/parallel/for_each.h"
#include "pipeline/app/lab/lab.h"
#include "pipeline/app/trials/numerics_options.h"
#include "pipeline/inspect/vehicle_report.h"
#include "pipeline/lab/validate/drawbar.h"
#include "pipeline/lab/validate/grade.h"
#include "pipeline/lab/validate/trials.h"

namespace gonogo::app {
namespace {

constexpr double kAllowedDeviation = 0.03;  // of slip and sinkage, relative

/// Options of the commands that run trials: vehicle, soil, backend.
template <class Request>
void add_trial_options(CLI::App& command, Request& request, std::string& vehicle, bool& gpu) {
  add_named(command, "--vehicle", vehicle, kVehicle, "Vehicle")->capture_default_str();
  add_named(command, "--soil", request.calibration, kFile, "Calibration JSON of the grains")->required();
  command.add_option("--friction-angle", request.friction_angle, "Friction angle of the soil [deg]")
      ->check(CLI::Range(5.0, 60.0));
  add_number(command, "--speed", request.speed, {0.1, 20.0}, "Commanded speed [m/s]");
  add_number(command, "--seeds", request.seeds, {1, 1000}, "Beds, one per seed");
  command.add_flag("--gpu", gpu, "Run on the GPU, all beds side by side");
}

campaign::BatchSettings batch_of(const Globals& globals, bool gpu, int seeds) {
  return {gpu ? sim::Backend::cuda : sim::Backend::cpu, gpu ? seeds : 1, threads_or_all(globals.threads)};
}

struct BedsOptions {
  lab::BedsRequest request;
  std::string vehicle;
  bool gpu = false;
};

/// Options of the comparisons of two beds. Callbacks keep what is returned.
std::shared_ptr<BedsOptions> add_beds_options(CLI::App& command, const std::string& vehicle) {
  auto o = std::make_shared<BedsOptions>();
  o->vehicle = vehicle;
  add_trial_options(command, o->request, o->vehicle, o->gpu);
  add_number(command, "--slope", o->request.slope, {-40.0, 40.0}, "Slope, uphill positive [deg]");
  add_number(command, "--distance", o->request.distance, {1.0, 1000.0}, "Distance to drive [m]");
  add_asked_numerics_options(command, o->request.numerics, "Trials", false);
  return o;
}

/// The request, completed after parsing by vehicle file and batch.
lab::BedsRequest request_of(const Globals& globals, const BedsOptions& o) {
  lab::BedsRequest request = o.request;
  request.vehicle = inspect::vehicle_file(o.vehicle);
  request.batch = batch_of(globals, o.gpu, request.seeds);
  return request;
}

/// Prints a comparison; throws DeviceError when slip or sinkage deviate too much.
void conclude(const Globals& globals, const Json& json, const std::string& text, double deviation,
              const std::string& beds) {
  if (deviation > kAllowedDeviation)
    fail_with_result(globals, json, text, DeviceError("slip or sinkage " + beds + " differ by more than 3 %"));
  print_result(globals, json, text);
}

void add_patch(CLI::App& command, const Globals& globals) {
  CLI::App* patch = command.add_subcommand(
      "patch", "A moving patch against a long fixed bed; fails when slip or sinkage differ by more than 3 %");
  const auto o = add_beds_options(*patch, "hmmwv_quarter");
  add_examples(*patch, {"gonogo validate patch --soil configs/soils/calibration_90mm.json --json"});
  patch->callback([&globals, o] {
    const lab::BedComparison c = lab::compare_patch(request_of(globals, *o));
    conclude(globals, lab::as_json(c), lab::as_text(c), c.worst_deviation(), "on the moving patch and on the long bed");
  });
}

void add_folded(CLI::App& command, const Globals& globals) {
  CLI::App* folded = command.add_subcommand(
      "folded", "A folded bed against several of it side by side; fails when slip or sinkage differ by more than 3 %");
  const auto o = add_beds_options(*folded, "hmmwv");
  const auto width = std::make_shared<double>(0);
  folded->add_option("--width", *width, "Width of the folded bed [m]; default: two thirds of the track")
      ->check(CLI::Range(0.1, 100.0));
  add_examples(*folded, {"gonogo validate folded --soil configs/soils/calibration_90mm.json --json"});
  folded->callback([&globals, o, width] {
    const lab::FoldedReport r = lab::compare_folded(request_of(globals, *o), *width);
    conclude(globals, lab::as_json(r), lab::as_text(r), r.beds.worst_deviation(),
             "on the folded bed and on the wide one");
  });
}

void add_drawbar(CLI::App& command, const Globals& globals) {
  CLI::App* drawbar = command.add_subcommand(
      "drawbar", "Drawbar pull and resistance of a vehicle on sand over slip, beside semi-empirical bands");
  struct Options {
    lab::DrawbarRequest request;
    std::string vehicle = "hmmwv", folder;
    bool gpu = false;
  };
  auto o = std::make_shared<Options>();
  add_trial_options(*drawbar, o->request, o->vehicle, o->gpu);
  add_asked_numerics_options(*drawbar, o->request.numerics, "Trials");
  add_number(*drawbar, "--sweep", o->request.sweep, {1.0, 1000.0}, "Time over which the load grows to the weight [s]");
  drawbar->add_flag("--compliant-tyres", o->request.compliant_tyres, "Tyres of the stiffness in the vehicle's file");
  add_wheel_rolling_option(*drawbar, o->request.wheel_rolling);
  drawbar->add_flag("--folded", o->request.folded, "Bed of two thirds of the track, with a third of the grains");
  add_named(*drawbar, "--out", o->folder, kFolder, "Folder for a table and a picture");
  add_examples(*drawbar, {"gonogo validate drawbar --soil configs/soils/calibration_90mm.json --out docs/validation"});
  drawbar->callback([&globals, o] {
    o->request.vehicle = inspect::vehicle_file(o->vehicle);
    o->request.batch = batch_of(globals, o->gpu, o->request.seeds);
    const lab::DrawbarReport r = lab::measure_drawbar(o->request);
    if (!o->folder.empty()) lab::write_drawbar(o->folder, r);
    print_result(globals, lab::as_json(r), lab::as_text(r));
  });
}

void add_grade(CLI::App& command, const Globals& globals) {
  CLI::App* grade = command.add_subcommand(
      "grade", "Slopes that the quarter wheel of a dataset climbs at its slips, beside semi-empirical bands");
  struct Options {
    lab::GradeRequest request;
    std::string vehicle = "hmmwv_quarter", folder;
  };
  auto o = std::make_shared<Options>();
  add_named(*grade, "dataset", o->request.dataset, kFile, "Dataset of quarter-vehicle trials")->required();
  add_named(*grade, "--vehicle", o->vehicle, kVehicle, "Quarter vehicle of the dataset")->capture_default_str();
  add_number(*grade, "--cohesion", o->request.max_cohesion, {0.0, 1000.0},
             "Max cohesion of the trials looked at [kPa]");
  add_number(*grade, "--cross-slope", o->request.max_across, {0.0, 90.0},
             "Max slope across of the trials looked at, either way [deg]");
  add_named(*grade, "--out", o->folder, kFolder, "Folder for a table and a picture");
  add_examples(*grade, {"gonogo validate grade data/quarter_wheel_32mm/dataset.h5 --out docs/validation"});
  grade->callback([&globals, o] {
    o->request.vehicle = inspect::vehicle_file(o->vehicle);
    const lab::GradeReport r = lab::grade_report(o->request);
    if (!o->folder.empty()) lab::write_grade(o->folder, r);
    print_result(globals, lab::as_json(r), lab::as_text(r));
  });
}

}  // namespace

void add_trial_checks(CLI::App& validate, const Globals& globals) {
  add_patch(validate, globals);
  add_folded(validate, globals);
  add_drawbar(validate, globals);
  add_grade(validate, globals);
}

}  // namespace gonogo::app
