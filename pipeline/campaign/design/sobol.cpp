#include "pipeline/campaign/design/sobol.h"

#include <array>

#include "base/random.h"

namespace gonogo::campaign {
namespace {

constexpr int kBits = 32;
constexpr std::uint64_t kScrambleStream = 0x5c7a3b1e00000000;  // apart from every other use of the study's seed

/// Primitive polynomial of degree `degree` with inner coefficients `a`, and the first direction integers.
struct Direction {
  int degree;
  std::uint32_t a;
  std::uint32_t m[7];
};

// Lines d = 2 .. 21 of new-joe-kuo-6.21201.
constexpr Direction kDirections[kSobolDimensions - 1] = {
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
};

using DirectionNumbers = std::array<std::uint32_t, kBits>;

/// Joe and Kuo, equations 2 and 3, with v_k = m_k / 2^k as 32-bit fractions.
DirectionNumbers direction_numbers(int dimension) {
  DirectionNumbers v{};
  if (dimension == 0) {
    for (int k = 0; k < kBits; ++k) v[k] = std::uint32_t(1) << (kBits - 1 - k);
    return v;
  }
  const Direction& d = kDirections[dimension - 1];
  for (int k = 0; k < kBits; ++k) {
    if (k < d.degree) {
      v[k] = d.m[k] << (kBits - 1 - k);
      continue;
    }
    v[k] = v[k - d.degree] ^ (v[k - d.degree] >> d.degree);
    for (int j = 1; j < d.degree; ++j)
      if ((d.a >> (d.degree - 1 - j)) & 1) v[k] ^= v[k - j];
  }
  return v;
}

const DirectionNumbers& directions_of(int dimension) {
  static const auto all = [] {
    std::array<DirectionNumbers, kSobolDimensions> table;
    for (int j = 0; j < kSobolDimensions; ++j) table[std::size_t(j)] = direction_numbers(j);
    return table;
  }();
  return all[std::size_t(dimension)];
}

}  // namespace

std::uint32_t sobol(std::uint32_t index, int dimension) {
  const DirectionNumbers& v = directions_of(dimension);
  const std::uint32_t gray = index ^ (index >> 1);
  std::uint32_t fraction = 0;
  for (int k = 0; k < kBits; ++k)
    if ((gray >> k) & 1) fraction ^= v[std::size_t(k)];
  return fraction;
}

std::uint32_t owen_scramble(std::uint32_t fraction, std::uint64_t seed, int dimension) {
  const std::uint64_t stream = kScrambleStream + std::uint64_t(dimension);
  std::uint32_t result = 0;
  for (int depth = 0; depth < kBits; ++depth) {
    // A node is a one followed by the unscrambled bits above: unique over all depths.
    const std::uint64_t node = (std::uint64_t(1) << depth) | (std::uint64_t(fraction) >> (kBits - depth));
    const std::uint32_t swap = std::uint32_t(random_bits(seed, stream, node) & 1);
    const int shift = kBits - 1 - depth;
    result |= (((fraction >> shift) & 1) ^ swap) << shift;
  }
  return result;
}

double scrambled_sobol(std::uint32_t index, std::uint64_t seed, int dimension) {
  return (double(owen_scramble(sobol(index, dimension), seed, dimension)) + 0.5) * 0x1.0p-32;
}

}  // namespace gonogo::campaign
