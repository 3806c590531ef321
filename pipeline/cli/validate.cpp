#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "base/cancel.h"
#include "base/error.h"
#include "pipeline/cli/command.h"
#include "pipeline/validate/fclib.h"
#include "pipeline/validate/vehicles.h"
#include "pipeline/vehicle/locate.h"

namespace gonogo::pipeline::cli {
namespace {

struct FclibRequest {
  std::vector<std::string> paths;
  std::string solver = "ppa", target = "coulomb";
  double limit = 1e-4;
  sim::LocalSolveSettings settings;
};

Json as_json(const FclibResult& r, const FclibRequest& request) {
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

std::string as_line(const FclibResult& r, const FclibRequest& request) {
  char line[160];
  std::snprintf(line, sizeof line, "%-34s %3d %8d  %-6s %10d %12.2e %10.2e %10.1f\n", r.name.c_str(), r.dimension,
                r.contacts, request.solver.c_str(), r.iterations, r.coulomb_error, r.ccp_error, r.ms);
  return line;
}

void validate_fclib(const Globals& globals, FclibRequest request) {
  request.settings.solver = sim::local_solver(request.solver);
  request.settings.target = request.target == "ccp" ? sim::ConeTarget::ccp : sim::ConeTarget::coulomb;
  const auto files = fclib_files({request.paths.begin(), request.paths.end()});
  std::string text =
      "problem                            dim contacts  solver iterations  coulomb err    ccp err         ms\n";
  Json rows = Json::array();
  int above = 0;
  for (const auto& file : files) {
    stop_if_cancelled();
    const FclibResult r = solve_fclib(file, request.settings);
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
    const vehicle::Vehicle v = vehicle::read_vehicle(vehicle_file(name));
    const auto reports = check_on_hard_ground(v, run);
    if (!request.folder.empty()) write_reports(request.folder, v.name, reports);
    json[v.name] = pipeline::as_json(reports);
    text += v.name + "\n" + as_text(reports);
    failed += failures(reports);
  }
  json["failed"] = failed;
  print_result(globals, json, text);
  if (failed > 0) throw DeviceError(std::to_string(failed) + " checks of vehicles on hard ground do not hold");
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

}  // namespace

void add_validate_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("validate", "Checks against what others published and closed forms");
  command->require_subcommand(1);
  const char* const example = "Example:\n  gonogo validate fclib tests/data/fclib";
  add_vehicles(*command, globals);
  command->footer(example);
  CLI::App* fclib = command->add_subcommand(
      "fclib", "Frictional contact problems in the formats of FCLib and Siconos; fails when one is not solved");
  auto request = std::make_shared<FclibRequest>();
  fclib->add_option("paths", request->paths, "Problem files, or folders of them (.hdf5, .dat)")->required();
  fclib->add_option("--solver", request->solver, "nsgs: block Gauss-Seidel; apgd: gradients; ppa: proximal Newton")
      ->check(CLI::IsMember({"nsgs", "apgd", "ppa"}))
      ->capture_default_str();
  fclib->add_option("--target", request->target, "coulomb, or ccp: its convex relaxation")
      ->check(CLI::IsMember({"coulomb", "ccp"}))
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

}  // namespace gonogo::pipeline::cli
