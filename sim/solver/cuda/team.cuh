// Teams of threads that work on one tile, and barriers across the grid.
#pragma once
#include "base/host_device.h"
#include "sim/solver/spectral.h"
#include "sim/state/contact_lists.h"
#include "sim/state/state.h"

namespace gonogo::sim {

inline constexpr Index kTeamsPerBlock = 4;
inline constexpr Index kBlockSize = kTeamsPerBlock * kTileSize;

/// 256 threads of a block that work on one tile.
struct Team {
  Index in_block, rank;  // rank: of the thread
  Index index, count;    // among all teams; neighbours sit on different multiprocessors
  double* scratch;       // one number per warp

  GONOGO_DEVICE void sync() const { asm volatile("bar.sync %0, %1;" ::"r"(in_block + 1), "n"(kTileSize) : "memory"); }

  /// Combines in a fixed order. The result is valid in the thread of rank 0.
  template <class Combine>
  GONOGO_DEVICE double reduce(double value, Combine combine) const {
    for (int offset = 16; offset > 0; offset /= 2) value = combine(value, __shfl_down_sync(0xFFFFFFFF, value, offset));
    sync();
    if (rank % 32 == 0) scratch[rank / 32] = value;
    sync();
    double all = scratch[0];
    if (rank == 0)
      for (int warp = 1; warp < kTileSize / 32; ++warp) all = combine(all, scratch[warp]);
    return all;
  }
  GONOGO_DEVICE double sum(double value) const {
    return reduce(value, [](double a, double b) { return a + b; });
  }
  GONOGO_DEVICE double max(double value) const {
    return reduce(value, [](double a, double b) { return std::fmax(a, b); });
  }
  GONOGO_DEVICE SpectralSums sum(const SpectralSums& value) const {
    return {sum(value.change_square), sum(value.curvature), sum(value.rise)};
  }
  GONOGO_DEVICE WorldSums sum(const WorldSums& value) const {
    WorldSums total;
    total.kinetic = sum(value.kinetic);
    total.gravity_power = sum(value.gravity_power);
    total.residual_square = sum(value.residual_square);
    total.residual_max = max(value.residual_max);
    return total;
  }
};

/// All blocks of a cooperative launch wait for each other and then see what the others wrote before. One counter, zero
/// at the start, holds the blocks that have arrived plus kWorldDone times the worlds that have ended. Arriving is a
/// reduction, which waits for no answer.
class GridBarrier {
 public:
  static constexpr unsigned long long kWorldDone = 1ull << 40;

  GONOGO_DEVICE explicit GridBarrier(unsigned long long* counter) : counter_(counter) {}

  /// Waits. Returns whether that many worlds have ended, the same for all threads.
  GONOGO_DEVICE bool wait(Index worlds = 0) {
    arrivals_ += gridDim.x;
    __syncthreads();
    const bool ended = threadIdx.x == 0 && arrive_and_wait() >= worlds;
    return __syncthreads_or(ended);
  }

 private:
  /// Returns how many worlds have ended.
  GONOGO_DEVICE Index arrive_and_wait() const {
    asm volatile("red.release.gpu.global.add.u64 [%0], 1;" ::"l"(counter_) : "memory");
    unsigned long long now;
    do asm volatile("ld.acquire.gpu.global.u64 %0, [%1];" : "=l"(now) : "l"(counter_) : "memory");
    while (now % kWorldDone < arrivals_);
    return Index(now / kWorldDone);
  }

  unsigned long long* counter_;
  unsigned long long arrivals_ = 0;
};

/// Loads here, even if a later branch may not need the value.
GONOGO_DEVICE float4 loaded_early(const float4* from) {
  float4 v;
  asm volatile("ld.global.v4.f32 {%0, %1, %2, %3}, [%4];" : "=f"(v.x), "=f"(v.y), "=f"(v.z), "=f"(v.w) : "l"(from));
  return v;
}
GONOGO_DEVICE Velocity loaded_early(const Velocity& from) {
  const auto* at = reinterpret_cast<const float4*>(&from);
  const float4 linear = loaded_early(at), angular = loaded_early(at + 1);
  return {{linear.x, linear.y, linear.z}, 0, {angular.x, angular.y, angular.z}, 0};
}

/// Sum over kLanes neighbouring threads of a warp; each of them gets it.
template <int kLanes>
GONOGO_DEVICE Vec3 sum_of_lanes(Vec3 v) {
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
