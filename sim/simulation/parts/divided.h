// One world divided over ranks, each of which simulates a part of it (part.h).
#pragma once
#include "base/ranks/ranks.h"
#include "sim/simulation/simulation.h"

namespace gonogo::sim {

/// This rank's view of the whole world, which takes the same steps, bit for bit, as one that make_simulation() makes.
/// All ranks call the same functions with the same arguments in the same order, and get the same answers. `ranks` must
/// live as long as the simulation. `threads`: of this rank.
/// On the CUDA backend the ranks are threads of one process, each of which has called use_cuda_device(); their GPUs
/// write into each other's memory. Throws InputError as make_simulation() does, and for a batch of several worlds, for
/// a method other than `apgd` and `jacobi`, for more than kMaxParts ranks, and for GPUs of several processes. Throws
/// OutOfMemory, in all ranks alike, when a part does not fit into a GPU. Later, DeviceError when a rank is lost.
std::unique_ptr<Simulation> make_divided_simulation(Backend backend, const SceneWorld& world,
                                                    const StepSettings& settings, int threads, Ranks& ranks);
std::unique_ptr<Simulation> make_divided_cuda_simulation(FlatWorld world, const StepSettings& settings, Ranks& ranks);

/// The same in one process, for one user: a thread for each part, on the CUDA backend with GPUs 0 to `parts` - 1.
/// Throws as make_divided_simulation() does, and InputError for more parts than GPUs.
std::unique_ptr<Simulation> make_team_simulation(Backend backend, const SceneWorld& world, const StepSettings& settings,
                                                 int parts);

/// "load of the GPUs 26 24 25 25 %", and "GPU 0: 1200 bodies, 4100 contacts, 26.1 % of the load; GPU 1: ...".
std::string loads_text(const std::vector<PartShare>& shares);
std::string shares_text(const std::vector<PartShare>& shares);

/// Bodies of a GPU's share that pay for its messages: 1 M over four GPUs is the smallest world that was seen to gain.
inline constexpr Index kBodiesThatPay = 250'000;

/// Over how many of `gpus` GPUs a world takes its steps fastest.
int gpus_that_pay(Index bodies, const StepSettings& settings, int gpus);

}  // namespace gonogo::sim
