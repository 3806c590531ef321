// The iteration on the GPU: the choice of the kernel.
#pragma once
#include "sim/solver/cuda/launch.cuh"

namespace gonogo::sim {

inline void solve(Cuda exec, State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings) {
  if (settings.solver == Solver::jacobi_scan) return solve_with_scans(exec, s, own.scan, settings);
  if (is_penalty(settings.solver)) return push_apart(exec, s, own.penalty, settings);
  clear(exec, own.counter.view());
  const bool in_substeps = settings.substeps > 1;
  if (!is_accelerated(settings.solver))
    solve_otherwise(exec, s, own, settings);
  else if (s.turning)
    in_substeps ? launch_solve<true, true>(exec, s, own, settings) : launch_solve<true, false>(exec, s, own, settings);
  else
    in_substeps ? launch_solve<false, true>(exec, s, own, settings)
                : launch_solve<false, false>(exec, s, own, settings);
}

}  // namespace gonogo::sim
