// The penalty family on the GPU: the same loops as on the host, each a kernel.
#include "sim/solver/cuda/launch.cuh"

namespace gonogo::sim {

void push_apart(Cuda exec, State<Cuda>& s, PenaltyStorage<Cuda>& own, const StepSettings& settings) {
  solve_by_penalty(exec, s, own, settings);
}

}  // namespace gonogo::sim
