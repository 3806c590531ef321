// The files of a bench of solvers: tables, and with cairo pictures.
#pragma once
#include "pipeline/lab/bench/solver_bench.h"

namespace gonogo::lab {

/// The table of the runs so far: times.csv in `folder`, which is created.
void write_solver_times(const std::filesystem::path& folder, const SolverBench& bench,
                        const std::vector<SolverRun>& runs);
/// The errors over iterations and time of the runs so far: curves.csv.
void write_solver_curves(const std::filesystem::path& folder, const std::vector<SolverRun>& runs);

/// Writes the files of all runs: curves.csv, profile.csv, times.csv, and with cairo profile.png and two curves per
/// problem (over time and over iterations), into `folder`, which is created. For scenes also growth.csv with its plots,
/// linear.csv, and motion.csv: momentum and kinetic energy, which all solvers must agree on.
void write_solver_bench(const std::filesystem::path& folder, const SolverBench& bench,
                        const std::vector<SolverRun>& runs);

}  // namespace gonogo::lab
