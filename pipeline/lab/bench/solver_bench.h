// Solvers of contact problems at equal error: convergence curves, performance profiles, growth with the number of
// bodies; problems from files made by others.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/lab/bench/step_scenes.h"
#include "sim/local_problem/methods/solve.h"

namespace gonogo::lab {

// Performance profiles (Dolan & More 2002): the share of problems that a solver ends within a factor tau of the
// fastest.

struct Profile {
  std::vector<double> tau;                 // increasing, from 1
  std::vector<std::vector<double>> share;  // rho [solver][tau], 0 .. 1
};

/// cost: [solver][problem], positive, infinite where the solver failed. A problem that no solver ends counts as failed
/// for all. tau: the ratios that occur.
Profile performance_profile(const std::vector<std::vector<double>>& cost);

/// Steps of one scene at several sizes.
struct SceneSizes {
  StepScene scene;
  std::vector<int> bodies;  // increasing
};

struct SolverBench {
  std::vector<std::filesystem::path> files;
  std::vector<SceneSizes> scenes;
  std::vector<sim::LocalSolver> solvers;
  std::vector<sim::Iteration> engine_solvers;           // the engine's own, on scenes, from a cold start
  std::vector<double> tolerances = {1e-3, 1e-6, 1e-8};  // of siconos_error, decreasing
  sim::LocalSolveSettings settings;                     // target, limits and facets; the tolerance is the last of these
  bool is_warm = false;                                 // solvers that can, start from the step before
  double skip_after = 60;  // a solver that took longer at a size of a scene is not run at larger ones [s]
  std::size_t most_whole = sim::StepProblem::kMostWhole;  // blocks of W; with more, products go by bodies
  int threads = 1;                                        // of the engine
  sim::Backend backend = sim::Backend::cpu;               // of the engine, which also settles the scenes
};

struct SolverRun {
  std::string problem, solver, refusal;
  std::string scene = {};  // empty for a file
  int bodies = 0;          // of a scene
  int contacts = 0, iterations = 0;
  double error = 0, lcp_error = 0;  // lcp_error: of solvers with facets, otherwise 0
  sim::StepMotion motion = {};      // at the end of the step; of a scene
  sim::LinearWork linear = {};
  std::vector<sim::TracePoint> trace = {};

  /// Processor seconds and iterations until the error was at `tolerance`; infinite when it never was.
  double seconds_to(double tolerance) const;
  double iterations_to(double tolerance) const;
};

/// Names in the order of the runs of each problem: the solvers, then "engine_" and the name of each of the engine's
/// where there are scenes.
std::vector<std::string> run_names(const SolverBench& bench);

/// What a caller is told while a bench goes on.
struct SolverBenchWatch {
  std::function<void(const std::string& what)> begins = [](const std::string&) {};  // settling a scene, or a run
  std::function<void(const SolverRun&)> ended = [](const SolverRun&) {};
};

/// Problems times solvers.
std::size_t run_count(const SolverBench& bench);

/// Runs of all solvers on all problems, problem by problem; every problem has the same number of runs, in the order of
/// run_names(). Throws InputError for malformed files, tolerances that do not fall and sizes that do not grow. Throws
/// Cancelled when the user asked to stop; `watch` has seen the runs that ended.
std::vector<SolverRun> bench_solvers(const SolverBench& bench, const SolverBenchWatch& watch = {});

/// Profile of the seconds to `tolerance`; solvers in the order of run_names().
Profile time_profile(const SolverBench& bench, const std::vector<SolverRun>& runs, double tolerance);

/// cost = factor * bodies^exponent, by least squares of the logarithms.
struct Growth {
  std::string scene, solver;
  double tolerance = 0;
  int sizes = 0;  // at which the tolerance was reached; below 2 the exponents are NaN
  double seconds_exponent = 0, iterations_exponent = 0;
};
/// Over all sizes of each scene.
std::vector<Growth> growth(const SolverBench& bench, const std::vector<SolverRun>& runs);

/// The same over contacts, of what the linear systems took: bytes, set-up and solution in processor time, rank. NaN
/// where fewer than two sizes have any.
struct LinearGrowth {
  std::string scene, solver;
  double bytes_exponent = 0, setup_exponent = 0, solve_exponent = 0, rank_exponent = 0;
};
/// For solvers that keep factors.
std::vector<LinearGrowth> linear_growth(const SolverBench& bench, const std::vector<SolverRun>& runs);

// The engine's own solvers on one step of a scene, from a cold start, judged by the error of the reference solvers.

/// "engine_" and the solver's name.
std::string engine_run_name(sim::Iteration solver);

/// Takes the step anew with more and more iterations until the error is at the tolerance, no longer falls (float has
/// the last word) or `max_iterations` (0: 10,000) are done. Seconds of the whole step, search for contacts included: on
/// the CPU processor time, on a GPU by the clock.
SolverRun engine_run(const SceneStep& step, const sim::StepProblem& problem, sim::Iteration solver,
                     const sim::LocalSolveSettings& settings, int threads, sim::Backend backend = sim::Backend::cpu);

// Frictional contact problems made by others, solved and judged by the error measure of Siconos.

struct FclibResult {
  std::string name, solver;  // of the file; sim::solver_name
  int dimension = 0, contacts = 0, iterations = 0;
  double coulomb_error = 0, ccp_error = 0;  // sim::siconos_error of the impulses found, for both targets
  double claimed_error = 0;                 // sim::claimed_error for the target asked for
  int facets = 0;                           // of the LCP family; its lcp_error is the claimed error
  std::string refusal;                      // why the solver did not take the problem; empty: it did
  sim::LinearWork linear;
  double ms = 0;          // solving, without reading
  std::vector<double> r;  // the impulses [contacts * dimension]
};

/// Files as given; a folder stands for its .hdf5 and .dat files, by name. Throws InputError for a path that is neither
/// and for a folder without such files.
std::vector<std::filesystem::path> fclib_files(const std::vector<std::filesystem::path>& paths);

/// Throws InputError for a malformed file; not reaching the tolerance is a result.
FclibResult solve_fclib(const std::filesystem::path& file, const sim::LocalSolveSettings& settings);

/// Writes `folder`/NAME.SOLVER.txt: a line per contact with its `dimension` impulses, normal first, to the last bit.
/// Creates the folder. Throws as create_folder and write_file_atomically do.
void write_impulses(const std::filesystem::path& folder, const FclibResult& result);

}  // namespace gonogo::lab
