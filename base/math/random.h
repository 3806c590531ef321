// Counter-based random numbers: value = f(seed, stream, index). No state; the same on CPU and GPU.
// Philox4x32-10 of Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3" (SC 2011), section 3.3;
// tests/base/random.cpp holds the authors' published answers.
#pragma once
#include <cmath>
#include <cstdint>

#include "base/host_device.h"
#include "base/units.h"

namespace gonogo {

struct RandomBlock {
  std::uint32_t word[4];
};

inline constexpr int kPhiloxRounds = 10;

/// The keys of all rounds, for kernels that draw many numbers.
struct PhiloxKeys {
  std::uint32_t round[kPhiloxRounds][2];

  GONOGO_HD explicit PhiloxKeys(std::uint64_t seed) {
    auto key0 = std::uint32_t(seed), key1 = std::uint32_t(seed >> 32);
    for (auto& key : round) {
      key[0] = key0;
      key[1] = key1;
      key0 += 0x9E3779B9u;
      key1 += 0xBB67AE85u;
    }
  }
};

/// One Philox4x32-10 block for a 128-bit counter and a 64-bit key.
GONOGO_HD inline RandomBlock philox(RandomBlock counter, const PhiloxKeys& keys) {
  for (const auto& key : keys.round) {
    const std::uint64_t product0 = std::uint64_t(0xD2511F53u) * counter.word[0];
    const std::uint64_t product1 = std::uint64_t(0xCD9E8D57u) * counter.word[2];
    counter = {{std::uint32_t(product1 >> 32) ^ counter.word[1] ^ key[0], std::uint32_t(product1),
                std::uint32_t(product0 >> 32) ^ counter.word[3] ^ key[1], std::uint32_t(product0)}};
  }
  return counter;
}

/// 128 random bits for draw `index` of stream `stream`.
GONOGO_HD inline RandomBlock random_block(const PhiloxKeys& keys, std::uint64_t stream, std::uint64_t index) {
  return philox(
      {{std::uint32_t(index), std::uint32_t(index >> 32), std::uint32_t(stream), std::uint32_t(stream >> 32)}}, keys);
}
GONOGO_HD inline RandomBlock random_block(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return random_block(PhiloxKeys(seed), stream, index);
}

GONOGO_HD inline std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  const RandomBlock block = random_block(seed, stream, index);
  return (std::uint64_t(block.word[1]) << 32) | block.word[0];
}

/// Uniform in [0, 1) with 53 random bits.
GONOGO_HD inline double random_unit(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return double(random_bits(seed, stream, index) >> 11) * 0x1.0p-53;
}

/// Normally distributed: mean 0, variance 1 / precision (Box and Muller, Ann. Math. Statist. 29:610, 1958). Uses the
/// uniform numbers 2 index and 2 index + 1 of the stream.
inline double random_normal(std::uint64_t seed, std::uint64_t stream, std::uint64_t index, double precision = 1) {
  const double u = 1 - random_unit(seed, stream, 2 * index), v = random_unit(seed, stream, 2 * index + 1);
  return std::sqrt(-2 * std::log(u) / precision) * std::cos(2 * kPi * v);
}

}  // namespace gonogo
