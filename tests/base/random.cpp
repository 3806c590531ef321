#include "base/math/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/catch.h"

namespace gonogo {
namespace {

struct KnownAnswer {
  std::array<std::uint32_t, 4> counter;
  std::array<std::uint32_t, 2> key;
  std::array<std::uint32_t, 4> result;
};

TEST_CASE("Philox4x32-10 gives the authors' known answers") {
  // kat_vectors of Random123 1.14, lines "philox4x32 10".
  const KnownAnswer answers[] = {{{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
                                 {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
                                  {0xffffffff, 0xffffffff},
                                  {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
                                 {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
                                  {0xa4093822, 0x299f31d0},
                                  {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}};
  for (const auto& [counter, key, result] : answers) {
    const RandomBlock block =
        philox({{counter[0], counter[1], counter[2], counter[3]}}, PhiloxKeys(std::uint64_t(key[1]) << 32 | key[0]));
    for (int i = 0; i < 4; ++i) CHECK(block.word[i] == result[std::size_t(i)]);
  }
}

TEST_CASE("seed, stream and index reach the generator in full") {
  // The pi-digit answer again, its counter and key packed as (stream, index) and seed.
  const RandomBlock block = random_block(0x299f31d0a4093822, 0x0370734413198a2e, 0x85a308d3243f6a88);
  CHECK(block.word[0] == 0xd16cfe09);
  CHECK(block.word[3] == 0x24126ea1);
  CHECK(random_bits(0x299f31d0a4093822, 0x0370734413198a2e, 0x85a308d3243f6a88) == 0x94fdccebd16cfe09);
}

TEST_CASE("the uniform numbers fill [0, 1) evenly") {
  // 64 bins, 64,000 draws: chi-squared with 63 degrees of freedom exceeds 113 once in 10,000.
  constexpr int bins = 64, draws = 64000;
  constexpr double expected = double(draws) / bins;
  std::array<int, bins> count{};
  double smallest = 1, largest = 0;
  for (int i = 0; i < draws; ++i) {
    const double u = random_unit(11, 3, std::uint64_t(i));
    smallest = std::min(smallest, u);
    largest = std::max(largest, u);
    ++count[std::size_t(u * bins)];
  }
  double chi_squared = 0;
  for (const int n : count) chi_squared += std::pow(n - expected, 2) / expected;
  CHECK(smallest >= 0);
  CHECK(largest < 1);
  CHECK(chi_squared < 113);
}

TEST_CASE("normal draws have the normal distribution, its moments and a variance of 1 / precision") {
  constexpr std::uint64_t kDraws = 100000;
  std::vector<double> x;
  double mean = 0, square = 0, fourth = 0, scaled = 0;
  for (std::uint64_t k = 0; k < kDraws; ++k) {
    x.push_back(random_normal(5, 2, k));
    mean += x.back() / kDraws;
    square += x.back() * x.back() / kDraws;
    fourth += std::pow(x.back(), 4) / kDraws;
    scaled += std::pow(random_normal(5, 2, k, 16), 2) / kDraws;
  }
  const double error = 1 / std::sqrt(double(kDraws));
  CHECK(std::abs(mean) < 4 * error);
  CHECK(std::abs(square - 1) < 4 * std::sqrt(2.0) * error);  // variances of x^2 and x^4: 2 and 96
  CHECK(std::abs(fourth - 3) < 4 * std::sqrt(96.0) * error);
  CHECK(scaled == Approx(square / 16));
  std::sort(x.begin(), x.end());
  double distance = 0;  // of Kolmogorov and Smirnov
  for (std::size_t k = 0; k < x.size(); ++k)
    distance = std::max(distance, std::abs(0.5 * std::erfc(-x[k] / std::sqrt(2.0)) - (double(k) + 0.5) / kDraws));
  CHECK(distance < 1.95 * error);  // passed by chance once in a thousand times
}

}  // namespace
}  // namespace gonogo
