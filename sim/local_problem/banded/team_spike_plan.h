// How a matrix is cut, for team_spike_on.h.
#pragma once
#include "sim/local_problem/banded/team_joint.h"
#include "sim/local_problem/banded/team_spike.h"

namespace gonogo::sim {

struct TeamSpikePlan {
  SpikeKind kind = SpikeKind::full;
  Partitions all;
  std::vector<PairsOfNodes> levels;  // partitions are nodes 0, 1, ...; truncated: one level; none for one partition
  Index nodes = 0, joints = 0;
  double largest = 0;  // on the diagonal
};

/// InputError where the matrix has 2^31 numbers or more.
TeamSpikePlan plan_team_spike(const BandedMatrix<double>& a, const TeamSpikeSettings& settings);

/// Of a program with CUDA.
std::unique_ptr<TeamSpike> make_team_spike_on_gpu(const TeamSpikePlan& plan, const std::vector<double>& a,
                                                  bool is_single);

}  // namespace gonogo::sim
