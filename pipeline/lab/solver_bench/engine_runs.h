// The engine's own solvers on one step of a scene, from a cold start, judged by the error of the reference solvers.
#pragma once
#include "pipeline/lab/solver_bench/solver_bench.h"

namespace gonogo::lab {

/// "engine_" and the solver's name.
std::string engine_run_name(sim::Solver solver);

/// Takes the step anew with more and more iterations until the error is at the tolerance, no longer falls (float has
/// the last word) or `max_iterations` (0: 10,000) are done. Seconds of the whole step, search for contacts included: on
/// the CPU processor time, on a GPU by the clock.
SolverRun engine_run(const SceneStep& step, const sim::StepProblem& problem, sim::Solver solver,
                     const sim::LocalSolveSettings& settings, int threads, sim::Backend backend = sim::Backend::cpu);

}  // namespace gonogo::lab
