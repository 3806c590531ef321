// The engine on the host's cores.
#include "sim/backend/simulation_on.h"

namespace gonogo::sim {

template class SimulationOn<Cpu>;

std::unique_ptr<Simulation> make_cpu_simulation(const FlatScene& scene, const StepSettings& settings, int threads) {
  return std::make_unique<SimulationOn<Cpu>>(Cpu{threads}, scene, settings);
}

}  // namespace gonogo::sim
