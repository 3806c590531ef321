#include "sim/simulation/parts/divided.h"

#include <algorithm>

#include "sim/scene/check_scene.h"
#include "sim/simulation/host_queue.h"
#include "sim/simulation/parts/divided_on.h"
#include "sim/simulation/parts/solve_part_host.h"

namespace gonogo::sim {

std::unique_ptr<Simulation> make_divided_simulation(Backend backend, const SceneWorld& world,
                                                    const StepSettings& settings, int threads, Ranks& ranks) {
  require_backend(backend);
  check_settings(settings);
  if (!can_be_divided(settings))
    throw InputError(std::string("a world cannot be divided for the method ") + name_of(settings.method()) +
                     "; use apgd or jacobi, or one rank");
  if (ranks.count() > kMaxParts)
    throw InputError("a world is to be divided over " + std::to_string(ranks.count()) + " ranks; allowed are 1 to " +
                     std::to_string(kMaxParts));
  FlatWorld flat = flatten(world, 0, settings);
#ifdef GONOGO_WITH_CUDA
  if (backend == Backend::cuda) {
    if (!ranks.share_memory())
      throw InputError("GPUs of several processes cannot divide a world; use the GPUs of one process");
    return make_divided_cuda_simulation(std::move(flat), settings, ranks);
  }
#endif
  return std::make_unique<DividedSimulation<Cpu>>(Cpu{threads}, std::move(flat), settings, ranks);
}

int gpus_that_pay(Index bodies, const StepSettings& settings, int gpus) {
  return can_be_divided(settings) ? std::clamp(int(bodies / kBodiesThatPay), 1, std::clamp(gpus, 1, kMaxGpus)) : 1;
}

}  // namespace gonogo::sim
