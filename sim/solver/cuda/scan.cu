// The baseline `jacobi_scan` on the GPU: the same loops as on the host, each a kernel.
#include "sim/solver/cuda/launch.cuh"

namespace gonogo::sim {

void solve_with_scans(Cuda exec, State<Cuda>& s, ScanStorage<Cuda>& own, const StepSettings& settings) {
  solve_by_scan(exec, s, own, settings);
}

}  // namespace gonogo::sim
