#include "pipeline/campaign/design/sobol.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/math/random.h"

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

// Lines d = 2 .. 37 of new-joe-kuo-6.21201: all polynomials of degree 7 and below.
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
    {7, 7, {1, 1, 3, 13, 7, 35, 63}},
    {7, 8, {1, 3, 5, 9, 1, 25, 53}},
    {7, 14, {1, 3, 1, 13, 9, 35, 107}},
    {7, 19, {1, 3, 1, 5, 27, 61, 31}},
    {7, 21, {1, 1, 5, 11, 19, 41, 61}},
    {7, 28, {1, 3, 5, 3, 3, 13, 69}},
    {7, 31, {1, 1, 7, 13, 1, 19, 1}},
    {7, 32, {1, 3, 7, 5, 13, 19, 59}},
    {7, 37, {1, 1, 3, 9, 25, 29, 41}},
    {7, 41, {1, 3, 5, 13, 23, 1, 55}},
    {7, 42, {1, 3, 7, 3, 13, 59, 17}},
    {7, 50, {1, 3, 1, 3, 5, 53, 69}},
    {7, 55, {1, 1, 5, 5, 23, 33, 13}},
    {7, 56, {1, 1, 7, 7, 1, 61, 123}},
    {7, 59, {1, 1, 7, 9, 13, 61, 49}},
    {7, 62, {1, 3, 3, 5, 3, 55, 33}},
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
  GONOGO_ASSERT(dimension >= 0 && dimension < kSobolDimensions);
  const DirectionNumbers& v = directions_of(dimension);
  const std::uint32_t gray = index ^ (index >> 1);
  std::uint32_t fraction = 0;
  for (int k = 0; k < kBits; ++k)
    if ((gray >> k) & 1) fraction ^= v[std::size_t(k)];
  return fraction;
}

namespace {

/// Nested uniform scrambling (A. B. Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences", 1995): each half of
/// each interval of the binary tree over [0, 1) swaps with the other at random. Hash-based form: B. Burley, "Practical
/// hash-based Owen scrambling", JCGT 9(4) (2020), section 3. Philox hashes (seed, dimension, node of the tree), so that
/// the swaps are independent to the last bit.
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

}  // namespace

double scrambled_sobol(std::uint32_t index, std::uint64_t seed, int dimension) {
  return (double(owen_scramble(sobol(index, dimension), seed, dimension)) + 0.5) * 0x1.0p-32;
}

namespace {

constexpr std::size_t kMaxCompared = 8192;  // points of a coverage, which compares all pairs
constexpr std::uint32_t kProbes = 4096;
constexpr std::size_t kClimbers = 8;
constexpr double kMinStep = 1e-4;  // [sides of the cube]

using Points = std::vector<std::vector<double>>;

/// [points][sampled variables] in the unit cube of the sampled box.
Points unit_points(const DesignSpec& spec, const std::vector<DesignPoint>& design) {
  Points points;
  for (const DesignPoint& point : design) {
    if (point.replicate_of >= 0) continue;
    if (points.size() == kMaxCompared) break;
    std::vector<double>& unit = points.emplace_back();
    for (const SampledVariable& range : spec.ranges)
      unit.push_back((point.variables[range.variable] - range.minimum) / (range.maximum - range.minimum));
  }
  return points;
}

double largest_gap(const Points& points, std::size_t dimension) {
  std::vector<double> values{0, 1};
  for (const auto& point : points) values.push_back(point[dimension]);
  std::sort(values.begin(), values.end());
  double gap = 0;
  for (std::size_t i = 1; i < values.size(); ++i) gap = std::max(gap, values[i] - values[i - 1]);
  return gap;
}

/// T. T. Warnock, "Computational investigations of low-discrepancy point sets" (1972): the square of the L2 norm.
double squared_discrepancy(const Points& points, std::size_t dimensions) {
  double single = 0, pairs = 0;
  for (const auto& a : points) {
    double product = 1;
    for (const double x : a) product *= (1 - x * x) / 2;
    single += product;
    for (const auto& b : points) {
      double pair = 1;
      for (std::size_t j = 0; j < dimensions; ++j) pair *= 1 - std::max(a[j], b[j]);
      pairs += pair;
    }
  }
  const double n = double(points.size());
  return std::pow(3.0, -double(dimensions)) - 2 * single / n + pairs / (n * n);
}

/// Squared distance to the nearest point, and which it is.
std::pair<double, const std::vector<double>*> nearest(const Points& points, const std::vector<double>& at) {
  std::pair<double, const std::vector<double>*> best{HUGE_VAL, nullptr};
  for (const auto& point : points) {
    double sum = 0;
    for (std::size_t j = 0; j < at.size() && sum < best.first; ++j) sum += (at[j] - point[j]) * (at[j] - point[j]);
    if (sum < best.first) best = {sum, &point};
  }
  return best;
}

/// Steps away from the nearest point while that helps, inside the cube.
double climb(const Points& points, std::vector<double> at) {
  auto [squared, closest] = nearest(points, at);
  for (double step = 0.1; step > kMinStep;) {
    std::vector<double> next = at;
    const double length = std::max(std::sqrt(squared), 1e-12);
    for (std::size_t j = 0; j < at.size(); ++j)
      next[j] = std::clamp(at[j] + step * (at[j] - (*closest)[j]) / length, 0.0, 1.0);
    const auto found = nearest(points, next);
    if (found.first > squared) {
      at = std::move(next);
      squared = found.first;
      closest = found.second;
    } else {
      step /= 2;
    }
  }
  return std::sqrt(squared);
}

}  // namespace

double largest_empty_ball(const Points& points, std::size_t dimensions) {
  if (points.empty()) return std::sqrt(double(dimensions));
  std::vector<std::pair<double, std::vector<double>>> probes;
  for (std::uint32_t i = 0; i < kProbes; ++i) {
    std::vector<double> at(dimensions);
    for (std::size_t j = 0; j < dimensions; ++j) at[j] = scrambled_sobol(i, 0, int(j));
    const double squared = nearest(points, at).first;
    probes.emplace_back(squared, std::move(at));
  }
  std::partial_sort(probes.begin(), probes.begin() + kClimbers, probes.end(),
                    [](const auto& a, const auto& b) { return a.first > b.first; });
  double radius = 0;
  for (std::size_t i = 0; i < kClimbers; ++i) radius = std::max(radius, climb(points, probes[i].second));
  return radius;
}

Coverage coverage(const DesignSpec& spec, const std::vector<DesignPoint>& design) {
  const Points points = unit_points(spec, design);
  const std::size_t dimensions = spec.ranges.size();
  Coverage result;
  result.discrepancy = std::sqrt(std::max(0.0, squared_discrepancy(points, dimensions)));
  // For independent uniform points the mean of the square is (2^-d - 3^-d) / n.
  result.expected_random =
      std::sqrt((std::pow(2.0, -double(dimensions)) - std::pow(3.0, -double(dimensions))) / double(points.size()));
  for (std::size_t j = 0; j < dimensions; ++j)
    result.largest_gap = std::max(result.largest_gap, largest_gap(points, j));
  result.empty_ball = largest_empty_ball(points, dimensions);
  return result;
}

}  // namespace gonogo::campaign
