// Files on scenes: growth with the number of bodies, and what all solvers must agree on.
#pragma once
#include "pipeline/lab/solver_bench/solver_bench.h"

namespace gonogo::lab {

/// growth.csv, linear.csv and motion.csv; a plot of time and one of iterations per scene and tolerance, where two sizes
/// are reached.
void write_growth(const std::filesystem::path& folder, const SolverBench& bench, const std::vector<SolverRun>& runs);

}  // namespace gonogo::lab
