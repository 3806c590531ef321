#include "sim/local_problem/banded/team_spike.h"

#include "sim/local_problem/banded/band_factors.h"
#include "sim/local_problem/banded/team_spike_on.h"

namespace gonogo::sim {
namespace {

/// Rows of a partition that keep the work on joints below that on partitions, and the steps of a team few.
Index rows_by_default(Index half) { return std::max<Index>(64, 8 * half); }

/// Pairs of pairs until one node is left.
void plan_tree(TeamSpikePlan& plan) {
  PairsOfNodes pairs{.first = 0, .nodes = plan.all.count, .parent = plan.all.count, .joint = 0, .is_tree = true};
  while (pairs.nodes > 1) {
    plan.levels.push_back(pairs);
    const Index parents = pairs.count();
    pairs = {.first = pairs.parent, .nodes = parents, .parent = pairs.parent + parents, .joint = pairs.joint + parents};
  }
  plan.nodes = pairs.parent;
  plan.joints = pairs.joint;
}

}  // namespace

TeamSpikePlan plan_team_spike(const BandedMatrix<double>& a, const TeamSpikeSettings& settings) {
  if (a.value.size() > std::size_t(std::numeric_limits<Index>::max()))
    throw InputError("SPIKE by teams: a band of " + std::to_string(a.value.size()) +
                     " numbers; at most 2147483647 are allowed");
  const Index n = Index(a.size), half = Index(a.half);
  const Index most = std::max<Index>(1, n / std::max<Index>(1, 2 * half));
  const Index wanted = settings.partitions > 0 ? settings.partitions : n / rows_by_default(half);
  TeamSpikePlan plan{.kind = settings.kind, .all = {n, half, std::clamp<Index>(wanted, 1, most)}};
  for (Index i = 0; i < n; ++i) plan.largest = std::max(plan.largest, std::fabs(a.at(i, i)));
  const Index count = plan.all.count;
  plan.nodes = count;
  if (count == 1 || half == 0) return plan;
  if (settings.kind == SpikeKind::full) {
    plan_tree(plan);
  } else {
    plan.levels = {{.first = 0, .nodes = count, .parent = 0, .joint = 0, .is_tree = false}};
    plan.joints = count - 1;
  }
  return plan;
}

std::unique_ptr<TeamSpike> team_spike_on_cpu(const BandedMatrix<double>& a, const TeamSpikeSettings& settings,
                                             int threads) {
  return make_team_spike(Cpu{threads}, plan_team_spike(a, settings), a.value, settings.is_single, [] {});
}

std::unique_ptr<TeamSpike> team_spike_on_gpu(const BandedMatrix<double>& a, const TeamSpikeSettings& settings) {
#ifdef GONOGO_WITH_CUDA
  return make_team_spike_on_gpu(plan_team_spike(a, settings), a.value, settings.is_single);
#else
  (void)a, (void)settings;
  throw InputError("SPIKE by teams: this program was built without CUDA; build the cuda-release preset");
#endif
}

}  // namespace gonogo::sim
