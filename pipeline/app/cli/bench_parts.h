// Options that the commands under `gonogo bench` share.
#pragma once
#include <map>
#include <string>

#include "pipeline/app/cli/command.h"
#include "sim/simulation/simulation.h"

namespace gonogo::app {

inline const std::map<std::string, sim::Backend> kBackends{{"cpu", sim::Backend::cpu}, {"cuda", sim::Backend::cuda}};

inline const std::map<std::string, sim::Solver> kSolvers{{"apgd", sim::Solver::apgd},
                                                         {"jacobi", sim::Solver::jacobi},
                                                         {"jacobi_scan", sim::Solver::jacobi_scan},
                                                         {"gauss_seidel", sim::Solver::gauss_seidel},
                                                         {"bb", sim::Solver::bb},
                                                         {"spring_damper", sim::Solver::spring_damper},
                                                         {"hertz", sim::Solver::hertz}};

template <class Value>
std::string name_in(const std::map<std::string, Value>& names, Value value) {
  for (const auto& [name, v] : names)
    if (v == value) return name;
  return "?";
}

/// An option whose value is one of `names`.
template <class Value>
void add_choice(CLI::App& command, const std::string& flag, Value& value, const std::map<std::string, Value>& names,
                const std::string& what) {
  std::vector<std::string> words;
  for (const auto& [name, v] : names) words.push_back(name);
  const auto set = [&value, names](const std::string& name) { value = names.at(name); };
  command.add_option_function<std::string>(flag, set, what)
      ->check(CLI::IsMember(words))
      ->default_str(name_in(names, value));
}

inline void add_solver(CLI::App& command, sim::Solver& solver) {
  add_choice(command, "--solver", solver, kSolvers,
             "Solver of the contacts; jacobi_scan is a baseline, spring_damper and hertz are penalty contact");
}

/// One core unless more are asked for.
inline int bench_threads(const Globals& globals) { return globals.threads > 0 ? globals.threads : 1; }

/// Reference solvers on problems from files.
void add_solver_bench(CLI::App& bench, const Globals& globals);

/// Scenes of many bodies.
void add_large_scenes(CLI::App& bench, const Globals& globals);

}  // namespace gonogo::app
