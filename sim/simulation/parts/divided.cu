#include "sim/simulation/device_queue.cuh"
#include "sim/simulation/parts/divided_on.h"
#include "sim/simulation/parts/solve_part.cuh"

namespace gonogo::sim {

std::unique_ptr<Simulation> make_divided_cuda_simulation(FlatWorld world, const StepSettings& settings, Ranks& ranks) {
  return std::make_unique<DividedSimulation<Cuda>>(Cuda{}, std::move(world), settings, ranks);
}

}  // namespace gonogo::sim
