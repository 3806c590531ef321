#include "learning/model/products/single_products.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/math/random.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

constexpr std::size_t kOutcomes = 7, kHidden = 37, kLanes = SingleProducts::kLanes;

/// Machine and points by number; fields are a part that all points share and one of their own.
struct Points {
  std::vector<double> bias, weight, shared, own;  // own: [hidden][lane]

  Points(double size, std::uint64_t seed) {
    std::uint64_t k = 0;
    const auto fill = [&](std::vector<double>& values, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) values.push_back(size * (2 * random_unit(seed, 3, k++) - 1));
    };
    fill(bias, kOutcomes);
    fill(weight, kOutcomes * kHidden);
    fill(shared, kHidden);
    fill(own, kHidden * kLanes);
  }

  /// P(outcome) of a point by logarithms in extended precision.
  std::vector<double> expected(std::size_t lane) const {
    std::vector<long double> score;
    for (std::size_t y = 0; y < kOutcomes; ++y) {
      long double sum = bias[y];
      for (std::size_t j = 0; j < kHidden; ++j)
        sum += std::log1p(std::exp((long double)(shared[j] + own[j * kLanes + lane] + weight[y * kHidden + j])));
      score.push_back(sum);
    }
    const long double most = *std::max_element(score.begin(), score.end());
    long double total = 0;
    for (long double& x : score) total += x = std::exp(x - most);
    std::vector<double> p;
    for (const long double x : score) p.push_back(double(x / total));
    return p;
  }

  std::optional<SingleProducts::Scaled> scaled(const SingleProducts& products) const {
    std::vector<double> lowest = shared, highest = shared, part(kHidden, 0.0);
    for (std::size_t j = 0; j < kHidden; ++j) {
      const auto [least, most] = std::minmax_element(&own[j * kLanes], &own[(j + 1) * kLanes]);
      lowest[j] += *least;
      highest[j] += *most;
      part[j] = std::max(std::abs(*least), std::abs(*most));
    }
    return products.scaled(lowest, highest, part);
  }
};

/// Shares of the outcomes at each lane, by adding each with weight 1 and the others with 0.
std::vector<double> shares(const Points& x, const SingleProducts& products, const SingleProducts::Scaled& scaled,
                           std::size_t lane) {
  std::vector<float> common, inverse;
  for (std::size_t j = 0; j < kHidden; ++j) common.push_back(float(std::exp(-x.shared[j]) * scaled.over_middle[j]));
  for (const double f : x.own) inverse.push_back(float(std::exp(-f)));
  std::vector<float> weight(kLanes, 0.0f);
  weight[lane] = 1;
  std::vector<double> sum(products.apart_count(), 0.0);
  products.add(scaled, common, inverse, weight, 1, sum);
  return products.all_outcomes(sum);
}

}  // namespace

TEST_CASE("P of products in single precision stays within the bound on its rounding") {
  for (const double size : {0.3, 1.0, 2.0})
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      const Points x(size, seed);
      const SingleProducts products(x.bias, x.weight);
      CHECK(products.error_bound() < 1e-5);
      const auto scaled = x.scaled(products);
      REQUIRE(scaled);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::vector<double> p = shares(x, products, *scaled, lane), expected = x.expected(lane);
        for (std::size_t y = 0; y < kOutcomes; ++y) CHECK(std::abs(p[y] - expected[y]) < products.error_bound());
      }
    }
}

TEST_CASE("outcomes of nearly the same weights are told apart within the bound of their likeness") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Points x(1, seed);
    for (const std::size_t y : {2, 4, 5})
      for (std::size_t j = 0; j < kHidden; ++j)
        x.weight[y * kHidden + j] = 0.001 * double(y) * x.weight[2 * kHidden + j];
    for (const std::size_t y : {2, 4, 5}) x.bias[y] -= 4;
    const SingleProducts products(x.bias, x.weight);
    CHECK(products.apart_count() == kOutcomes - 2);
    const auto scaled = x.scaled(products);
    REQUIRE(scaled);
    double most = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::vector<double> p = shares(x, products, *scaled, lane), expected = x.expected(lane);
      std::vector<double> sum(products.apart_count(), 0.0);
      sum[2] = p[2] + p[4] + p[5];  // the third that is told apart
      for (std::size_t y = 0; y < kOutcomes; ++y) {
        CHECK(std::abs(p[y] - expected[y]) < products.error_bound() + products.alike_error(sum));
        most = std::max(most, std::abs(p[y] - expected[y]));
      }
    }
    CHECK(most < 1e-3);
  }
}

TEST_CASE("fields whose products leave the range of float are refused") {
  const Points x(30, 5);
  const SingleProducts products(x.bias, x.weight);
  CHECK_FALSE(x.scaled(products));
}
