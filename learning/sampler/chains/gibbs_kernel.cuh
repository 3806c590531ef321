// The fused kernel: a block keeps the weights and the states of its chains on its multiprocessor through all sweeps.
// Tensor cores add the fields of 16 chains x 16 units at a time; the threads that hold the sums draw the units at once.
#pragma once
#include <cuda_fp16.h>

#include "base/math/random.h"
#include "learning/sampler/chains/gpu_chains.h"

namespace gonogo::learning {

/// Units of a side come in tiles of 16. Inside a tile they are stored in such an order that a thread of a warp, which
/// holds the sums of columns 2t, 2t + 1, 8 + 2t and 9 + 2t (PTX ISA, fragments of mma.m16n8k16), draws four units that
/// follow each other: one block of random numbers.
inline constexpr int kTile = 16;

/// Unit -> column. Units are counted from `shift`, so that blocks of random numbers do not straddle threads.
GONOGO_HD inline int column_of_unit(int unit, int shift) {
  const int at = unit + shift, in_tile = at % kTile, thread = in_tile / 4, number = in_tile % 4;
  return at - in_tile + number / 2 * 8 + 2 * thread + number % 2;
}

/// Warps of a block at most: two blocks then share a multiprocessor's registers. Sides of so many tiles have kernels of
/// their own.
inline constexpr int kMaxWarps = 12;

struct GibbsSide {
  int units, shift, tiles;
  const float* field;  // [tiles * 16] -bias / ln 2 in the order of the units; large where there is no unit

  GONOGO_HD int width() const { return tiles * kTile; }
  /// Rows of halves that eight threads load from different banks.
  GONOGO_HD int stride() const { return width() + 8; }
};

struct GibbsMachine {
  GibbsSide left, right;
  const __half* weight;  // [left width x right stride], in columns
  PhiloxKeys keys;
  int chains;
  std::uint8_t* row;  // [chain x (left + right)]
  unsigned* begun;    // [block]: 1 once the first stretch of the block lies in memory; 0 before the launch

  GONOGO_HD std::uint64_t blocks_per_sweep() const { return (left.units + right.units + 3) / 4; }
};

/// Where things lie in a block's shared memory; `chains` of the block.
struct GibbsRoom {
  std::size_t left, right, left_field, right_field, bytes;

  GONOGO_HD GibbsRoom(const GibbsSide& l, const GibbsSide& r, int chains) {
    left = sizeof(__half) * l.width() * r.stride();
    right = left + sizeof(__half) * chains * l.stride();
    left_field = right + sizeof(__half) * chains * r.stride();
    right_field = left_field + sizeof(float) * l.width();
    bytes = right_field + sizeof(float) * r.width();
  }
};

/// Four 8 x 8 matrices of halves; lane 8 i + r gives the address of row r of matrix i.
__device__ inline void load_matrices(std::uint32_t (&to)[4], const __half* row) {
  const auto address = std::uint32_t(__cvta_generic_to_shared(row));
  asm volatile("ldmatrix.sync.aligned.m8n8.x4.shared.b16 {%0, %1, %2, %3}, [%4];"
               : "=r"(to[0]), "=r"(to[1]), "=r"(to[2]), "=r"(to[3])
               : "r"(address));
}
__device__ inline void load_transposed(std::uint32_t (&to)[4], const __half* row) {
  const auto address = std::uint32_t(__cvta_generic_to_shared(row));
  asm volatile("ldmatrix.sync.aligned.m8n8.x4.trans.shared.b16 {%0, %1, %2, %3}, [%4];"
               : "=r"(to[0]), "=r"(to[1]), "=r"(to[2]), "=r"(to[3])
               : "r"(address));
}

/// sum = a b, and sum += a b, for 16 x 16 by 16 x 8.
__device__ inline void multiply(float (&sum)[4], const std::uint32_t (&a)[4], std::uint32_t b0, std::uint32_t b1) {
  asm("mma.sync.aligned.m16n8k16.row.col.f32.f16.f16.f32 {%0, %1, %2, %3}, {%4, %5, %6, %7}, {%8, %9}, {%10, %10, %10, "
      "%10};"
      : "=f"(sum[0]), "=f"(sum[1]), "=f"(sum[2]), "=f"(sum[3])
      : "r"(a[0]), "r"(a[1]), "r"(a[2]), "r"(a[3]), "r"(b0), "r"(b1), "f"(0.0f));
}
__device__ inline void multiply_add(float (&sum)[4], const std::uint32_t (&a)[4], std::uint32_t b0, std::uint32_t b1) {
  asm("mma.sync.aligned.m16n8k16.row.col.f32.f16.f16.f32 {%0, %1, %2, %3}, {%4, %5, %6, %7}, {%8, %9}, {%0, %1, %2, "
      "%3};"
      : "+f"(sum[0]), "+f"(sum[1]), "+f"(sum[2]), "+f"(sum[3])
      : "r"(a[0]), "r"(a[1]), "r"(a[2]), "r"(a[3]), "r"(b0), "r"(b1));
}

/// 1 where u < 1 / (1 + exp(-field)), u = word / 2^32, otherwise 0. `exponent`: -field / ln 2.
__device__ inline float draw(std::uint32_t word, float exponent) {
  const float u = __uint2float_rn(word);
  float power, on;
  asm("ex2.approx.ftz.f32 %0, %1;" : "=f"(power) : "f"(exponent));
  asm("set.lt.f32.f32 %0, %1, %2;" : "=f"(on) : "f"(__fmaf_rn(u, power, u)), "f"(0x1p32f));
  return on;
}

/// `kChains`: tiles of 16 chains that a block holds. `kSideTiles`: of both sides, known to the compiler, with a warp
/// for each; 0: as the machine says.
template <int kChains, int kSideTiles>
class GibbsBlock {
 public:
  __device__ GibbsBlock(const GibbsMachine& machine, std::uint8_t* memory)
      : m(machine),
        weight_(reinterpret_cast<__half*>(memory)),
        lane_(int(threadIdx.x) % 32),
        warp_(int(threadIdx.x) / 32),
        warps_(int(blockDim.x) / 32) {
    const GibbsRoom room(m.left, m.right, kChains * kTile);
    left_ = reinterpret_cast<__half*>(memory + room.left);
    right_ = reinterpret_cast<__half*>(memory + room.right);
    left_field_ = reinterpret_cast<float*>(memory + room.left_field);
    right_field_ = reinterpret_cast<float*>(memory + room.right_field);
  }

  /// Weights and biases, once.
  __device__ void load_machine() {
    const int weights = m.left.width() * m.right.stride() / 8;
    for (int i = int(threadIdx.x); i < weights; i += int(blockDim.x))
      reinterpret_cast<uint4*>(weight_)[i] = reinterpret_cast<const uint4*>(m.weight)[i];
    for (int i = int(threadIdx.x); i < m.left.width(); i += int(blockDim.x)) left_field_[i] = m.left.field[i];
    for (int i = int(threadIdx.x); i < m.right.width(); i += int(blockDim.x)) right_field_[i] = m.right.field[i];
    clear(left_, m.left);
    clear(right_, m.right);
    __syncthreads();
  }

  /// States of a group of chains, past the first cache: another block may have written them. Many loads are under way
  /// at once.
  __device__ void load_states(int group) {
    constexpr int kAtOnce = 8;
    first_chain_ = group * kChains * kTile;
    const int count = state_count(), step = int(blockDim.x);
    const std::uint8_t* from = row();
    for (int first = int(threadIdx.x); first < count; first += kAtOnce * step) {
      std::uint8_t bit[kAtOnce];
#pragma unroll
      for (int n = 0; n < kAtOnce; ++n)
        if (const int i = first + n * step; i < count) bit[n] = __ldcg(from + i);
#pragma unroll
      for (int n = 0; n < kAtOnce; ++n)
        if (const int i = first + n * step; i < count) state(i) = __float2half(bit[n] ? 1.0f : 0.0f);
    }
    __syncthreads();
  }

  __device__ void sweep(std::uint64_t sweep) {
    const std::uint64_t right_block = sweep * m.blocks_per_sweep(), left_block = right_block + m.right.units / 4;
    draw_side<true>(left_, m.left, right_, m.right, right_field_, right_block);
    __syncthreads();
    draw_side<false>(right_, m.right, left_, m.left, left_field_, left_block);
    __syncthreads();
  }

  __device__ void store_states() {
    std::uint8_t* to = row();
    for (int i = int(threadIdx.x); i < state_count(); i += int(blockDim.x)) to[i] = __half2float(state(i)) > 0;
    __syncthreads();
  }

 private:
  __device__ void clear(__half* state, const GibbsSide& side) {
    for (int i = int(threadIdx.x); i < kChains * kTile * side.stride(); i += int(blockDim.x))
      state[i] = __float2half(0.0f);
  }

  /// Units of all chains of the group, one after another as they lie in memory.
  __device__ int state_count() const {
    const int rest = m.chains - first_chain_;
    return (rest < kChains * kTile ? rest : kChains * kTile) * units();
  }
  __device__ int units() const { return m.left.units + m.right.units; }
  __device__ std::uint8_t* row() const { return m.row + std::size_t(first_chain_) * units(); }

  __device__ __half& state(int i) const {
    const int chain = i / units(), unit = i % units();
    return unit < m.left.units ? left_[chain * m.left.stride() + column_of_unit(unit, m.left.shift)]
                               : right_[chain * m.right.stride() + column_of_unit(unit - m.left.units, m.right.shift)];
  }

  __device__ static int tiles(const GibbsSide& side) { return kSideTiles > 0 ? kSideTiles : side.tiles; }
  __device__ static int stride(const GibbsSide& side) {
    return kSideTiles > 0 ? kSideTiles * kTile + 8 : side.stride();
  }

  __device__ int warps() const { return kSideTiles > 0 ? kSideTiles : warps_; }

  /// Draws one side given the other. `first_block`: of random numbers.
  template <bool to_right>
  __device__ void draw_side(const __half* from, const GibbsSide& given, __half* to, const GibbsSide& drawn,
                            const float* field, std::uint64_t first_block) {
    for (int n = warp_; n < tiles(drawn); n += warps()) {
      float sum[kChains][2][4];
      add_tile<to_right, true>(from, stride(given), n, 0, sum);
#pragma unroll
      for (int k = 1; k < tiles(given); ++k) add_tile<to_right, false>(from, stride(given), n, k, sum);
      draw_tile(sum, to, stride(drawn), n, reinterpret_cast<const float4*>(field)[4 * n + lane_ % 4], first_block);
    }
  }

  template <bool to_right, bool first>
  __device__ void add_tile(const __half* from, int from_stride, int n, int k, float (&sum)[kChains][2][4]) {
    const int row = lane_ % 16, half = lane_ / 16 * 8;
    std::uint32_t w[4];
    if constexpr (to_right)
      load_transposed(w, weight_ + (k * kTile + row) * stride(m.right) + n * kTile + half);
    else
      load_matrices(w, weight_ + (n * kTile + half + lane_ % 8) * stride(m.right) + k * kTile + lane_ / 8 % 2 * 8);
#pragma unroll
    for (int c = 0; c < kChains; ++c) {
      std::uint32_t state[4];
      load_matrices(state, from + (c * kTile + row) * from_stride + k * kTile + half);
      if constexpr (first) {
        multiply(sum[c][0], state, w[0], w[1]);
        multiply(sum[c][1], state, w[2], w[3]);
      } else {
        multiply_add(sum[c][0], state, w[0], w[1]);
        multiply_add(sum[c][1], state, w[2], w[3]);
      }
    }
  }

  __device__ void draw_tile(const float (&sum)[kChains][2][4], __half* to, int stride, int n, const float4& field,
                            std::uint64_t first_block) {
    constexpr float kMinusPerLn2 = -1.44269504f;
    const int thread = lane_ % 4;
#pragma unroll
    for (int c = 0; c < kChains; ++c)
#pragma unroll
      for (int r = 0; r < 2; ++r) {
        const int chain = c * kTile + lane_ / 4 + 8 * r;
        const RandomBlock random =
            random_block(m.keys, std::uint64_t(first_chain_ + chain), first_block + std::uint64_t(4 * n + thread));
        const float(&low)[4] = sum[c][0], (&high)[4] = sum[c][1];
        auto* pair = reinterpret_cast<__half2*>(to + chain * stride + n * kTile + 2 * thread);
        pair[0] = __floats2half2_rn(draw(random.word[0], __fmaf_rn(low[2 * r], kMinusPerLn2, field.x)),
                                    draw(random.word[1], __fmaf_rn(low[2 * r + 1], kMinusPerLn2, field.y)));
        pair[4] = __floats2half2_rn(draw(random.word[2], __fmaf_rn(high[2 * r], kMinusPerLn2, field.z)),
                                    draw(random.word[3], __fmaf_rn(high[2 * r + 1], kMinusPerLn2, field.w)));
      }
  }

  const GibbsMachine& m;
  __half *weight_, *left_, *right_;
  float *left_field_, *right_field_;
  int lane_, warp_, warps_, first_chain_ = 0;
};

__device__ inline void announce(unsigned* flag) {
  __threadfence();
  atomicExch(flag, 1u);
}
__device__ inline void wait_for(unsigned* flag) {
  while (atomicAdd(flag, 0u) == 0) __nanosleep(200);
  __threadfence();
}

/// Sweeps number `first` + 1 .. `first` + `count`. All blocks run at once (cooperative launch) and none takes more than
/// its share of the sweeps (chain_share.h).
template <int kChains, int kSideTiles>
__global__ void __launch_bounds__(32 * (kSideTiles > 0 ? kSideTiles : kMaxWarps), 2)
    gibbs_kernel(const __grid_constant__ GibbsMachine machine, std::uint64_t first, std::uint64_t count) {
  extern __shared__ __align__(16) std::uint8_t memory[];
  GibbsBlock<kChains, kSideTiles> block(machine, memory);
  block.load_machine();
  const int groups = (machine.chains + kChains * kTile - 1) / (kChains * kTile);
  ChainShare share(std::uint64_t(groups), count, int(blockIdx.x), int(gridDim.x));
  while (!share.done()) {
    const ChainStretch stretch = share.next();
    if (stretch.begin > 0) {
      if (threadIdx.x == 0) wait_for(machine.begun + blockIdx.x + 1);
      __syncthreads();
    }
    block.load_states(int(stretch.group));
    for (std::uint64_t k = stretch.begin; k < stretch.end; ++k) block.sweep(first + k + 1);
    block.store_states();
    if (stretch.end < count && threadIdx.x == 0) announce(machine.begun + blockIdx.x);
  }
}

/// Independent fair bits: row 0 of the chain's random numbers.
struct ScatterChain {
  GibbsMachine m;

  GONOGO_HD void operator()(Index chain) const {
    const int left = m.left.units, right = m.right.units;
    for (int unit = 0; unit < left + right; ++unit) {
      const RandomBlock random = random_block(m.keys, std::uint64_t(chain), std::uint64_t(unit / 4));
      const int in_row = unit < right ? left + unit : unit - right;  // the right side is drawn first
      m.row[std::size_t(chain) * (left + right) + in_row] = random.word[unit % 4] < 0x80000000u;
    }
  }
};

}  // namespace gonogo::learning
