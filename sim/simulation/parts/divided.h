// One world divided over ranks, each of which simulates a part of it (part.h).
#pragma once
#include <functional>

#include "base/ranks/ranks.h"
#include "sim/simulation/simulation.h"

namespace gonogo::sim {

/// The parts of a divided world. What the makers below return is one.
class InParts {
 public:
  /// In: the state of a part's own bodies and their contacts, by indices of the world; the first part holds the rest.
  using Work = std::function<std::string(const Snapshot& own, int part)>;
  virtual ~InParts() = default;

  /// Calls `work` for each part, in its rank or thread. Returns what all of them returned, by part.
  virtual std::vector<std::string> each_part(const Work& work) = 0;
};

/// The same object as InParts, or null for worlds in one piece.
inline InParts* in_parts(Simulation& simulation) { return dynamic_cast<InParts*>(&simulation); }

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
