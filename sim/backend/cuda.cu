// The engine on a GPU: the same stages, instantiated.
#include "sim/backend/simulation_on.h"

namespace gonogo::sim {

template class SimulationOn<Cuda>;

std::unique_ptr<Simulation> make_cuda_simulation(const FlatScene& scene, const StepSettings& settings) {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0)
    throw InputError("no CUDA device on this machine; ask for the cpu backend");
  return std::make_unique<SimulationOn<Cuda>>(Cuda{}, scene, settings);
}

}  // namespace gonogo::sim
