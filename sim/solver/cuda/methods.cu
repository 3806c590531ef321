// The methods for comparison on the GPU: one kernel each, for turning contacts and substeps.
#include "sim/solver/cuda/launch.cuh"

namespace gonogo::sim {

void solve_otherwise(Cuda exec, State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings) {
  if (settings.solver == Solver::gauss_seidel)
    launch_solve<true, true, Solver::gauss_seidel>(exec, s, own, settings);
  else
    launch_solve<true, true, Solver::bb>(exec, s, own, settings);
}

}  // namespace gonogo::sim
