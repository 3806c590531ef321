// Parts of the commands `gonogo bench` and `gonogo validate`.
#pragma once
#include <map>
#include <string>

#include "base/format.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/app/trials/numerics_options.h"
#include "sim/law/contact_law.h"
#include "sim/local_problem/methods/solve.h"

namespace gonogo::app {

inline const std::map<std::string, sim::ContactMethod> kSolvers = [] {
  std::map<std::string, sim::ContactMethod> methods;
  for (const std::string& name : sim::method_names()) methods[name] = sim::method_named(name);
  return methods;
}();

inline void add_solver(CLI::App& command, sim::ContactMethod& solver) {
  std::vector<std::string> laws;
  for (const std::string& name : sim::contact_names())
    if (sim::is_penalty(sim::contact_named(name))) laws.push_back(name);
  add_choice(command, "--solver", solver, kSolvers,
             "Solver of the contacts; jacobi_scan is a baseline, and of penalty contact are " + join_words(laws));
}

/// --solver and --target of the reference solvers (sim/local_problem).
inline void add_reference_solvers(CLI::App& command, std::vector<std::string>& solvers, std::string& target) {
  add_list(command, "--solver", solvers,
           "nsgs: block Gauss-Seidel; apgd: gradients; ppa: proximal Newton; pdip: interior point, pdip_spike and "
           "pdip_krylov without factorisations; admm: alternating directions; lemke, pgs, fb_newton, qp: polygons "
           "for discs; jacobi, gauss_seidel, nesterov, minres: ccp alone. Several")
      ->check(CLI::IsMember(sim::solver_names()))
      ->capture_default_str();
  command.add_option("--target", target, "coulomb, or ccp: its convex relaxation")
      ->check(CLI::IsMember(sim::target_names()))
      ->capture_default_str();
}

/// One core unless more are asked for.
inline int bench_threads(const Globals& globals) { return globals.threads > 0 ? globals.threads : 1; }

// Commands below bench: reference solvers on problems from files, scenes of many bodies.
void add_solver_bench(CLI::App& bench, const Globals& globals);
void add_large_scenes(CLI::App& bench, const Globals& globals);

// Commands below validate; trial checks are patch, folded, drawbar and grade.
void add_fclib_check(CLI::App& validate, const Globals& globals);
void add_trial_checks(CLI::App& validate, const Globals& globals);
void add_wheels_check(CLI::App& validate, const Globals& globals);

}  // namespace gonogo::app
