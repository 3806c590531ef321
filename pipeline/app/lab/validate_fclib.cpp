#include <memory>

#include "base/format.h"
#include "base/progress.h"
#include "pipeline/app/lab/lab.h"
#include "pipeline/lab/bench/solver_bench.h"
#include "sim/law/contact_law.h"

namespace gonogo::app {
namespace {

struct FclibRequest {
  std::vector<std::string> paths;
  std::vector<std::string> solvers = {"ppa"};
  std::string target = "coulomb";
  std::filesystem::path impulses;  // folder; empty: none are written
  double limit = 1e-4;
  sim::LocalSolveSettings settings;
};

Json linear_json(const sim::LinearWork& work) {
  Json json;
  json["solves"] = Json(std::int64_t(work.solves));
  json["inner_iterations"] = Json(std::int64_t(work.inner_iterations));
  json["setup_ms"] = work.setup_ms;
  json["solve_ms"] = work.solve_ms;
  json["bytes"] = Json(std::uint64_t(work.bytes));
  json["multiply_adds"] = work.multiply_adds;
  json["half_bandwidth"] = Json(std::int64_t(work.half));
  json["full_half_bandwidth"] = Json(std::int64_t(work.full_half));
  json["partitions"] = work.partitions;
  json["dropped_share"] = work.dropped;
  return json;
}

Json as_json(const lab::FclibResult& r) {
  Json json;
  json["problem"] = r.name;
  json["dimension"] = r.dimension;
  json["contacts"] = r.contacts;
  json["solver"] = r.solver;
  json["iterations"] = r.iterations;
  json["siconos_error"] = r.coulomb_error;
  json["ccp_error"] = r.ccp_error;
  json["ms"] = r.ms;
  if (r.facets > 0) json["facets"] = r.facets;
  if (r.facets > 0 && r.refusal.empty()) json["lcp_error"] = r.claimed_error;
  if (!r.refusal.empty()) json["refused"] = r.refusal;
  if (r.linear.solves > 0) json["linear"] = linear_json(r.linear);
  return json;
}

std::string as_line(const lab::FclibResult& r) {
  if (!r.refusal.empty()) return r.name + ": " + r.refusal + "\n";
  std::string text = line("%-34s %3d %8d  %-12s %10d %12.2e %10.2e %10.1f", r.name.c_str(), r.dimension, r.contacts,
                          r.solver.c_str(), r.iterations, r.coulomb_error, r.ccp_error, r.ms);
  if (r.facets > 0)
    text += line("  lcp %.1e; the rest is the error of %d facets", r.claimed_error, r.dimension == 2 ? 2 : r.facets);
  else if (r.linear.solves > 0 && r.linear.inner_iterations == 0)
    text += line("  set-up %.1f ms, solve %.1f ms, %.2f MB", r.linear.setup_ms, r.linear.solve_ms,
                 double(r.linear.bytes) / 1e6);
  else if (r.linear.solves > 0)
    text += line("  %ld inner, set-up %.1f ms, solve %.1f ms, %.2f MB, band %td of %td, P %d",
                 r.linear.inner_iterations, r.linear.setup_ms, r.linear.solve_ms, double(r.linear.bytes) / 1e6,
                 r.linear.half, r.linear.full_half, r.linear.partitions);
  return text + "\n";
}

void validate_fclib(const Globals& globals, FclibRequest request) {
  request.settings.target = sim::target_named(request.target);
  const auto files = lab::fclib_files({request.paths.begin(), request.paths.end()});
  std::string text =
      "problem                            dim contacts  solver       iterations  coulomb err    ccp err         ms\n";
  Json rows = Json::array();
  int above = 0;
  for (const auto& file : files)
    for (const std::string& solver : request.solvers) {
      stop_if_cancelled();
      request.settings.solver = sim::local_solver(solver);
      const lab::FclibResult r = lab::solve_fclib(file, request.settings);
      if (!request.impulses.empty()) lab::write_impulses(request.impulses, r);
      rows.push_back(as_json(r));
      text += as_line(r);
      above += !(r.claimed_error <= request.limit);
    }
  Json json;
  json["target"] = request.target;
  json["limit"] = request.limit;
  json["above_limit"] = above;
  json["problems"] = rows;
  const std::string sentence =
      line("%d of %zu problems ended above the error %g", above, files.size() * request.solvers.size(), request.limit);
  if (above > 0) fail_with_result(globals, json, text, DeviceError(sentence));
  print_result(globals, json, text);
}

}  // namespace

void add_fclib_check(CLI::App& validate, const Globals& globals) {
  CLI::App* fclib = validate.add_subcommand(
      "fclib", "Frictional contact problems in the formats of FCLib and Siconos; fails when one is not solved");
  auto request = std::make_shared<FclibRequest>();
  add_named(*fclib, "paths", request->paths, kFile, "Problem files, or folders of them (.hdf5, .dat)")->required();
  add_reference_solvers(*fclib, request->solvers, request->target);
  add_named(*fclib, "--impulses", request->impulses, kFile,
            "Folder for the impulses: a file per problem and solver, a line per contact, normal first");
  add_number(*fclib, "--tolerance", request->settings.tolerance, {1e-15, 1.0}, "Error at which a solver stops");
  add_number(*fclib, "--limit", request->limit, {1e-15, 1.0}, "Error above which a problem counts as not solved");
  add_number(*fclib, "--iterations", request->settings.max_iterations, {0, 100000000},
             "Max iterations; 0: the solver's own limit");
  add_number(*fclib, "--facets", request->settings.facets, {4, 256},
             "lemke, pgs, fb_newton, qp: facets of a cone, even");
  add_number(*fclib, "--omega", request->settings.omega, {0.0, 1.99}, "jacobi, gauss_seidel: relaxation; 0: 0.2 and 1");
  add_number(*fclib, "--lambda", request->settings.lambda, {1e-3, 1.0}, "jacobi, gauss_seidel: smoothing");
  add_examples(*fclib,
               {"gonogo validate fclib tests/data/fclib",
                "gonogo validate fclib tests/data/fclib --solver ppa,pdip --limit 1e-8  # which solves which",
                "gonogo validate fclib tests/data/fclib/NESpheres_10_1.dat --solver lemke,fb_newton --facets 32"});
  fclib->callback([&globals, request] { validate_fclib(globals, *request); });
}

}  // namespace gonogo::app
