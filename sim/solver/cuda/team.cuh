// Threads that work on one tile.
#pragma once
#include "sim/solver/tiles.h"
#include "sim/world/state.h"

namespace gonogo::sim {

inline constexpr Index kTeamsPerBlock = 4;
inline constexpr Index kBlockSize = kTeamsPerBlock * kTileSize;

/// 256 threads of a block that work on one tile.
struct Team {
  Index in_block, rank;  // rank: of the thread
  Index index, count;    // among all teams; neighbours sit on different multiprocessors
  double* scratch;       // one number per warp

  __device__ void sync() const { asm volatile("bar.sync %0, %1;" ::"r"(in_block + 1), "n"(kTileSize) : "memory"); }

  /// The same bits whatever else runs; valid in the thread of rank 0.
  template <class Combine>
  __device__ double reduce(double value, Combine combine) const {
    for (int offset = 16; offset > 0; offset /= 2) value = combine(value, __shfl_down_sync(0xFFFFFFFF, value, offset));
    sync();
    if (rank % 32 == 0) scratch[rank / 32] = value;
    sync();
    double all = scratch[0];
    if (rank == 0)
      for (int warp = 1; warp < kTileSize / 32; ++warp) all = combine(all, scratch[warp]);
    return all;
  }
  __device__ double sum(double value) const {
    return reduce(value, [](double a, double b) { return a + b; });
  }
  __device__ double most(double value) const {
    return reduce(value, [](double a, double b) { return std::fmax(a, b); });
  }
  __device__ WorldSums sum(const WorldSums& value) const {
    WorldSums total;
    total.kinetic = sum(value.kinetic);
    total.gravity_power = sum(value.gravity_power);
    total.residual_square = sum(value.residual_square);
    total.residual_max = most(value.residual_max);
    return total;
  }
};

/// Of neighbouring threads of a warp; all of them get it.
template <int kLanes>
__device__ inline Vec3 sum_of_lanes(Vec3 v) {
  const unsigned mask = kLanes == 32 ? 0xFFFFFFFFu : ((1u << kLanes) - 1) << (threadIdx.x % 32 / kLanes * kLanes);
#pragma unroll
  for (int offset = 1; offset < kLanes; offset *= 2) {
    v.x += __shfl_xor_sync(mask, v.x, offset);
    v.y += __shfl_xor_sync(mask, v.y, offset);
    v.z += __shfl_xor_sync(mask, v.z, offset);
  }
  return v;
}

}  // namespace gonogo::sim
