#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "base/cancel.h"
#include "base/error.h"
#include "base/shipped.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/app/cli/numerics_options.h"
#include "pipeline/lab/validate/drawbar.h"
#include "pipeline/lab/validate/fclib.h"
#include "pipeline/lab/validate/folded.h"
#include "pipeline/lab/validate/given_slip.h"
#include "pipeline/lab/validate/grade.h"
#include "pipeline/lab/validate/patch.h"
#include "pipeline/lab/validate/slope_slip.h"
#include "pipeline/lab/validate/soils.h"
#include "pipeline/lab/validate/vehicles.h"
#include "pipeline/lab/vehicle/locate.h"
#include "sim/scene/target_name.h"

namespace gonogo::app {
namespace {

struct FclibRequest {
  std::vector<std::string> paths;
  std::string solver = "ppa", target = "coulomb";
  double limit = 1e-4;
  sim::LocalSolveSettings settings;
};

Json as_json(const lab::FclibResult& r, const FclibRequest& request) {
  Json json;
  json["problem"] = r.name;
  json["dimension"] = r.dimension;
  json["contacts"] = r.contacts;
  json["solver"] = request.solver;
  json["iterations"] = r.iterations;
  json["siconos_error"] = r.coulomb_error;
  json["ccp_error"] = r.ccp_error;
  json["ms"] = r.ms;
  return json;
}

std::string as_line(const lab::FclibResult& r, const FclibRequest& request) {
  char line[160];
  std::snprintf(line, sizeof line, "%-34s %3d %8d  %-6s %10d %12.2e %10.2e %10.1f\n", r.name.c_str(), r.dimension,
                r.contacts, request.solver.c_str(), r.iterations, r.coulomb_error, r.ccp_error, r.ms);
  return line;
}

void validate_fclib(const Globals& globals, FclibRequest request) {
  request.settings.solver = sim::local_solver(request.solver);
  request.settings.target = sim::target_named(request.target);
  const auto files = lab::fclib_files({request.paths.begin(), request.paths.end()});
  std::string text =
      "problem                            dim contacts  solver iterations  coulomb err    ccp err         ms\n";
  Json rows = Json::array();
  int above = 0;
  for (const auto& file : files) {
    stop_if_cancelled();
    const lab::FclibResult r = lab::solve_fclib(file, request.settings);
    rows.push_back(as_json(r, request));
    text += as_line(r, request);
    above += r.target_error > request.limit;
  }
  Json json;
  json["target"] = request.target;
  json["limit"] = request.limit;
  json["above_limit"] = above;
  json["problems"] = rows;
  print_result(globals, json, text);
  char sentence[120];
  std::snprintf(sentence, sizeof sentence, "%d of %zu problems ended above the error %g", above, files.size(),
                request.limit);
  if (above > 0) throw DeviceError(sentence);
}

struct VehiclesRequest {
  std::vector<std::string> vehicles{"hmmwv"};
  std::string folder;
  bool gpu = false;
};

void validate_vehicles(const Globals& globals, const VehiclesRequest& request) {
  const vehicle::HardGroundRun run{request.gpu ? sim::Backend::cuda : sim::Backend::cpu, std::max(1, globals.threads)};
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
  print_result(globals, json, text);
  if (failed > 0) throw DeviceError(std::to_string(failed) + " checks of vehicles on hard ground do not hold");
}

struct SoilsRequest {
  std::vector<std::string> figures;
  std::string folder;
  lab::SoilValidation tests;
  lab::SimulantRun wheel;
};

lab::SoilFigure figure_of(const std::string& name, SoilsRequest& request, int threads) {
  request.tests.threads = request.wheel.threads = threads;
  request.wheel.vehicle = name == "mgru3_rover" ? lab::kSimulantRover : lab::kSimulantWheel;
  if (name == "mgru3" || name == "mgru3_rover")
    return lab::slope_slip_figure(request.wheel, lab::run_slope_slip(request.wheel));
  if (name == "trec") return lab::given_slip_figure(request.wheel, lab::run_given_slips(request.wheel));
  return lab::soil_figure(name, request.tests);
}

void validate_soils(const Globals& globals, SoilsRequest& request) {
  const int threads = globals.threads > 0 ? globals.threads : int(std::thread::hardware_concurrency());
  Json json = Json::object(), checks = Json::object();
  std::string text;
  int failed = 0;
  for (const std::string& name : request.figures) {
    stop_if_cancelled();
    const lab::SoilFigure figure = figure_of(name, request, threads);
    if (!request.folder.empty()) lab::write_figure(request.folder, figure);
    text += lab::as_text(figure);
    for (const lab::SoilCheck& c : figure.check) json[c.key] = c.measured, failed += !c.holds();
    checks[name] = lab::as_json(figure);
  }
  json["failed"] = failed;
  json["checks"] = checks;
  print_result(globals, json, text);
  if (failed > 0) throw DeviceError(std::to_string(failed) + " checks of soils do not hold");
}

/// Of the figures with a wheel or the rover on a simulant.
void add_wheel_options(CLI::App& soils, lab::SimulantRun& wheel) {
  CLI::App& of = *soils.add_option_group("mgru3, mgru3_rover, trec", "A wheel or the rover on a lunar simulant");
  add_asked_numerics_options(of, wheel.numerics, "Trials");
  of.add_option("--grain", wheel.grain, "Diameter of the grains, if not the table's [m]")
      ->check(CLI::Range(0.002, 0.2));
  of.add_option("--depth", wheel.depth, "Of the bed [m]")->check(CLI::Range(0.05, 2.0))->capture_default_str();
  of.add_option("--length", wheel.length, "Of the bed; without it 2, for the rover 3.5 [m]")
      ->check(CLI::Range(0.5, 20.0));
  of.add_option("--width", wheel.width, "Of the bed; without it 0.7, for the rover two thirds of its track [m]")
      ->check(CLI::Range(0.3, 10.0));
  of.add_option("--time", wheel.time, "Driven, of which the last half counts; without it 8, for the rover 24 [s]")
      ->check(CLI::Range(1.0, 100.0));
  of.add_option("--wheel-friction", wheel.wheel_friction, "Of grains on the wheels [-]")
      ->check(CLI::Range(0.0, 2.0))
      ->capture_default_str();
  of.add_option("--state", wheel.state, "Of configs/soils/grc1.json (trec: grc3.json), if not the first");
  of.add_flag("--gpu", wheel.gpu, "On the GPU");
}

void add_soils(CLI::App& command, const Globals& globals) {
  CLI::App* soils = command.add_subcommand(
      "soils",
      "Soil tests, soils through the calibration, a wheel and a rover on slopes; fails when a bound is not kept");
  auto request = std::make_shared<SoilsRequest>();
  request->figures = lab::soil_figures();
  request->figures.insert(request->figures.end(), {"mgru3", "mgru3_rover", "trec"});
  const std::vector<std::string> all = request->figures;
  auto calibration = std::make_shared<std::string>("calibration_90mm"), wheel = std::make_shared<std::string>();
  auto seeds = std::make_shared<int>(2);
  soils->add_option("figures", request->figures, "Which of them")->check(CLI::IsMember(all))->capture_default_str();
  soils->add_option("--calibration", *calibration, "Table of the grains to be tested")->capture_default_str();
  soils->add_option("--wheel-calibration", *wheel, "Table of the grains of mgru3, mgru3_rover and trec, if another");
  soils->add_option("--seeds", *seeds, "Beds for each test")->check(CLI::Range(1, 100))->capture_default_str();
  soils->add_flag("--quick", request->tests.quick, "Smaller beds and shorter ways, for a first look");
  soils->add_option("--out", request->folder, "Folder for a figure and a table of each");
  add_wheel_options(*soils, request->wheel);
  soils->footer(
      "Examples:\n  gonogo validate soils shear triaxial --out docs/validation --json\n"
      "  gonogo validate soils mgru3_rover --calibration calibration_32mm --grain 0.016 --depth 0.15 --seeds 1 --gpu");
  soils->callback([&globals, request, calibration, wheel, seeds] {
    const auto table = [](const std::string& name) { return shipped_file("soils", "calibration", name); };
    request->tests.calibration = table(*calibration);
    request->wheel.calibration = wheel->empty() ? request->tests.calibration : table(*wheel);
    request->tests.seeds = request->wheel.seeds = *seeds;
    validate_soils(globals, *request);
  });
}

void add_vehicles(CLI::App& command, const Globals& globals) {
  CLI::App* vehicles = command.add_subcommand(
      "vehicles", "Whole vehicles on hard ground against closed forms; fails when one does not hold");
  auto request = std::make_shared<VehiclesRequest>();
  vehicles->add_option("vehicles", request->vehicles, "Vehicle files, or names of ones in configs/vehicles")
      ->capture_default_str();
  vehicles->add_option("--out", request->folder, "Folder for a figure and a table of every kind of check");
  vehicles->add_flag("--gpu", request->gpu, "On the GPU");
  vehicles->footer("Example:\n  gonogo validate vehicles --out docs/validation --json");
  vehicles->callback([&globals, request] { validate_vehicles(globals, *request); });
}

/// Vehicle, soil and where it runs, of the commands that run trials.
template <class Request>
void add_trial_options(CLI::App& command, Request& request, std::string& vehicle, bool& gpu) {
  command.add_option("--vehicle", vehicle, "Vehicle file, or the name of one in configs/vehicles")
      ->capture_default_str();
  command.add_option("--soil", request.calibration, "Calibration JSON of the grains")->required();
  command.add_option("--friction-angle", request.friction_angle, "Of the soil [deg]")->check(CLI::Range(5.0, 60.0));
  command.add_option("--speed", request.speed, "Commanded [m/s]")->check(CLI::Range(0.1, 20.0))->capture_default_str();
  command.add_option("--seeds", request.seeds, "Beds")->check(CLI::Range(1, 1000))->capture_default_str();
  command.add_flag("--gpu", gpu, "On the GPU, all beds side by side");
}

campaign::BatchSettings batch_of(const Globals& globals, bool gpu, int seeds) {
  return {gpu ? sim::Backend::cuda : sim::Backend::cpu, gpu ? seeds : 1, std::max(1, globals.threads)};
}

struct BedsOptions {
  lab::BedsRequest request;
  std::string vehicle;
  bool gpu = false;
};

/// What the comparisons of two beds have in common. Everything that runs later holds on to what is returned.
std::shared_ptr<BedsOptions> add_beds_options(CLI::App& command, const std::string& vehicle) {
  auto o = std::make_shared<BedsOptions>();
  o->vehicle = vehicle;
  add_trial_options(command, o->request, o->vehicle, o->gpu);
  command.add_option("--slope", o->request.slope, "Uphill [deg]")
      ->check(CLI::Range(-40.0, 40.0))
      ->capture_default_str();
  command.add_option("--distance", o->request.distance, "To drive [m]")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  add_asked_numerics_options(command, o->request.numerics, "Trials", false);
  return o;
}

/// Runs the comparison, prints it, and fails when slip or sinkage differ too much.
template <class Compare>
void compare(const Globals& globals, BedsOptions& o, Compare&& compare_two, const std::string& failure) {
  o.request.vehicle = lab::vehicle_file(o.vehicle);
  o.request.batch = batch_of(globals, o.gpu, o.request.seeds);
  if (compare_two(o.request) > 0.03) throw DeviceError(failure);
}

void add_patch(CLI::App& command, const Globals& globals) {
  CLI::App* patch = command.add_subcommand(
      "patch", "A moving patch against a long fixed bed; fails when slip or sinkage differ by more than 3 %");
  const auto o = add_beds_options(*patch, "hmmwv_quarter");
  patch->footer("Example:\n  gonogo validate patch --soil configs/soils/calibration_90mm.json --json");
  patch->callback([&globals, o] {
    const auto run = [&](const lab::BedsRequest& request) {
      const lab::BedComparison c = lab::compare_patch(request);
      print_result(globals, lab::as_json(c), lab::as_text(c));
      return c.worst_deviation();
    };
    compare(globals, *o, run, "slip or sinkage on the moving patch differ by more than 3 % from those on the long bed");
  });
}

void add_folded(CLI::App& command, const Globals& globals) {
  CLI::App* folded = command.add_subcommand(
      "folded", "A folded bed against several of it side by side; fails when slip or sinkage differ by more than 3 %");
  const auto o = add_beds_options(*folded, "hmmwv");
  const auto width = std::make_shared<double>(0);
  folded->add_option("--width", *width, "Of the folded bed; without it two thirds of the track [m]")
      ->check(CLI::Range(0.1, 100.0));
  folded->footer("Example:\n  gonogo validate folded --soil configs/soils/calibration_90mm.json --json");
  folded->callback([&globals, o, width] {
    const auto run = [&](const lab::BedsRequest& request) {
      const lab::FoldedReport r = lab::compare_folded(request, *width);
      print_result(globals, lab::as_json(r), lab::as_text(r));
      return r.beds.worst_deviation();
    };
    compare(globals, *o, run, "slip or sinkage on the folded bed differ by more than 3 % from those on the wide one");
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
  drawbar->add_option("--sweep", o->request.sweep, "Over which the load grows to the weight [s]")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  drawbar->add_flag("--compliant-tyres", o->request.compliant_tyres,
                    "With the stiffness that the vehicle's file names");
  drawbar->add_flag("--folded", o->request.folded, "On a bed of two thirds of the track: a third of the grains");
  drawbar->add_option("--out", o->folder, "Folder for a table and a picture");
  drawbar->footer(
      "Example:\n  gonogo validate drawbar --soil configs/soils/calibration_90mm.json --out docs/validation");
  drawbar->callback([&globals, o] {
    o->request.vehicle = lab::vehicle_file(o->vehicle);
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
  grade->add_option("dataset", o->request.dataset, "Dataset of quarter-vehicle trials")->required();
  grade->add_option("--vehicle", o->vehicle, "Its quarter vehicle, a file or the name of one in configs/vehicles")
      ->capture_default_str();
  grade->add_option("--cohesion", o->request.max_cohesion, "Most of the trials looked at [kPa]")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  grade->add_option("--cross-slope", o->request.max_across, "Most of the trials looked at, either way [deg]")
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
  grade->add_option("--out", o->folder, "Folder for a table and a picture");
  grade->footer("Example:\n  gonogo validate grade data/quarter_wheel_32mm/dataset.h5 --out docs/validation");
  grade->callback([&globals, o] {
    o->request.vehicle = lab::vehicle_file(o->vehicle);
    const lab::GradeReport r = lab::grade_report(o->request);
    if (!o->folder.empty()) lab::write_grade(o->folder, r);
    print_result(globals, lab::as_json(r), lab::as_text(r));
  });
}

}  // namespace

void add_validate_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("validate", "Checks against what others published and closed forms");
  command->require_subcommand(1);
  const char* const example = "Example:\n  gonogo validate fclib tests/data/fclib";
  add_vehicles(*command, globals);
  add_soils(*command, globals);
  add_patch(*command, globals);
  add_folded(*command, globals);
  add_drawbar(*command, globals);
  add_grade(*command, globals);
  command->footer(example);
  CLI::App* fclib = command->add_subcommand(
      "fclib", "Frictional contact problems in the formats of FCLib and Siconos; fails when one is not solved");
  auto request = std::make_shared<FclibRequest>();
  fclib->add_option("paths", request->paths, "Problem files, or folders of them (.hdf5, .dat)")->required();
  fclib->add_option("--solver", request->solver, "nsgs: block Gauss-Seidel; apgd: gradients; ppa: proximal Newton")
      ->check(CLI::IsMember({"nsgs", "apgd", "ppa"}))
      ->capture_default_str();
  fclib->add_option("--target", request->target, "coulomb, or ccp: its convex relaxation")
      ->check(CLI::IsMember(sim::target_names()))
      ->capture_default_str();
  fclib->add_option("--tolerance", request->settings.tolerance, "Error at which a solver stops")
      ->check(CLI::Range(1e-15, 1.0))
      ->capture_default_str();
  fclib->add_option("--limit", request->limit, "Error above which a problem counts as not solved")
      ->check(CLI::Range(1e-15, 1.0))
      ->capture_default_str();
  fclib->add_option("--iterations", request->settings.max_iterations, "Most iterations; 0: the solver's own limit")
      ->check(CLI::Range(0, 100000000))
      ->capture_default_str();
  fclib->footer(example);
  fclib->callback([&globals, request] { validate_fclib(globals, *request); });
}

}  // namespace gonogo::app
