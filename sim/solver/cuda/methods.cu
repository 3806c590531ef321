// The methods for comparison on the GPU: one kernel each for turning contacts and substeps; jacobi_scan and the penalty
// family as the same loops as on the host, each a kernel.
#include "sim/solver/cuda/launch.cuh"

namespace gonogo::sim {

void solve_otherwise(Cuda exec, State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings) {
  if (settings.iteration == Iteration::gauss_seidel)
    launch_solve<true, true, Iteration::gauss_seidel>(exec, s, own, settings);
  else
    launch_solve<true, true, Iteration::bb>(exec, s, own, settings);
}

void push_apart(Cuda exec, State<Cuda>& s, PenaltyStorage<Cuda>& own, const StepSettings& settings) {
  solve_by_penalty(exec, s, own, settings);
}

void solve_with_scans(Cuda exec, State<Cuda>& s, ScanStorage<Cuda>& own, const StepSettings& settings) {
  solve_by_scan(exec, s, own, settings);
}

}  // namespace gonogo::sim
