// The iteration on the GPU: which kernel takes a step.
#pragma once
#include "sim/solver/cuda/launch.cuh"

namespace gonogo::sim {

inline void solve(Cuda exec, State<Cuda>& s, const StepSettings& settings) {
  if (settings.solver == Solver::jacobi_scan) return solve_with_scans(exec, s, settings);
  clear(exec, s.solver.counter.view());
  const bool parts = settings.substeps > 1;
  if (!is_accelerated(settings.solver))
    solve_otherwise(exec, s, settings);
  else if (s.turning)
    parts ? launch_solve<true, true>(exec, s, settings) : launch_solve<true, false>(exec, s, settings);
  else
    parts ? launch_solve<false, true>(exec, s, settings) : launch_solve<false, false>(exec, s, settings);
}

}  // namespace gonogo::sim
