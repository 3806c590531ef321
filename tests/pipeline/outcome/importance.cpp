#include "pipeline/outcome/importance/importance.h"

#include <cmath>

#include "base/math/random.h"
#include "base/units.h"
#include "tests/support/catch.h"

namespace gonogo::outcome {

namespace {

/// Applies a function of one point to many.
template <class F>
ManyValues many(std::size_t dimensions, F f) {
  return [=](std::span<const double> points, std::span<double> values) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = f(points.subspan(i * dimensions, dimensions));
  };
}

TEST_CASE("total indices of Ishigami's function are the ones of its closed form") {
  // T. Ishigami and T. Homma (1990): sin x1 + a sin^2 x2 + b x3^4 sin x1 over [-pi, pi]^3.
  constexpr double a = 7, b = 0.1;
  const auto f = many(3, [](std::span<const double> x) {
    return std::sin(x[0]) + a * std::pow(std::sin(x[1]), 2) + b * std::pow(x[2], 4) * std::sin(x[0]);
  });
  const double pi4 = std::pow(kPi, 4), pi8 = pi4 * pi4;
  const double variance = a * a / 8 + b * pi4 / 5 + b * b * pi8 / 18 + 0.5;
  const double v13 = b * b * pi8 * (1.0 / 18 - 1.0 / 50), v1 = 0.5 * std::pow(1 + b * pi4 / 5, 2), v2 = a * a / 8;
  const TotalIndices found = sobol_total_indices(f, {{-kPi, -kPi, -kPi}, {kPi, kPi, kPi}}, 8192, 3);
  CHECK(found.variance == Approx(variance).epsilon(0.02));
  CHECK(found.total[0] == Approx((v1 + v13) / variance).margin(0.015));
  CHECK(found.total[1] == Approx(v2 / variance).margin(0.015));
  CHECK(found.total[2] == Approx(v13 / variance).margin(0.015));
}

TEST_CASE("an input that does nothing has the index 0, and a constant function has none at all") {
  const auto f = many(2, [](std::span<const double> x) { return 3 * x[0]; });
  const TotalIndices found = sobol_total_indices(f, {{0, 0}, {1, 5}}, 1024, 1);
  CHECK(found.total[0] == Approx(1).epsilon(0.02));
  CHECK(found.total[1] == 0);
  const auto constant = many(2, [](std::span<const double>) { return 0.25; });
  CHECK(sobol_total_indices(constant, {{0, 0}, {1, 1}}, 64, 1).total == std::vector<double>{0, 0});
}

TEST_CASE("permuting an input of a sum costs twice its variance, one that is not used nothing") {
  constexpr std::size_t count = 4000;
  std::vector<double> points, truth;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = random_unit(1, 0, i), y = random_unit(1, 1, i), z = random_unit(1, 2, i);
    points.insert(points.end(), {x, y, z});
    truth.push_back(x + 3 * y);
  }
  const auto f = many(3, [](std::span<const double> p) { return p[0] + 3 * p[1]; });
  const std::vector<double> found = permutation_importance(f, points, 3, truth, 3, 7);
  CHECK(found[0] == Approx(2.0 / 12).epsilon(0.05));
  CHECK(found[1] == Approx(2 * 9.0 / 12).epsilon(0.05));
  CHECK(found[2] == Approx(0).margin(1e-12));
}

}  // namespace
}  // namespace gonogo::outcome
