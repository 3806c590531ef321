#include "learning/score/score.h"

#include <algorithm>
#include <cmath>

#include "base/math/random.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

double sigmoid(double x) { return 1 / (1 + std::exp(-x)); }

/// Forecasts whose logits are uniform on +-3 and outcomes with logit offset + slope times theirs.
struct Made {
  std::vector<double> p;
  std::vector<int> happened;
};
Made made_forecasts(std::size_t count, double offset, double slope, std::uint64_t seed) {
  Made made;
  for (std::size_t k = 0; k < count; ++k) {
    const double x = 6 * random_unit(seed, 1, k) - 3;
    made.p.push_back(sigmoid(x));
    made.happened.push_back(random_unit(seed, 2, k) < sigmoid(offset + slope * x));
  }
  return made;
}

}  // namespace

TEST_CASE("the bootstrap interval of a mean is the normal one for many values, and holds the mean 95 times in 100") {
  std::vector<double> values;
  for (std::size_t k = 0; k < 2000; ++k) values.push_back(random_unit(3, 3, k));
  const Interval interval = bootstrap_mean(values, 1);
  const double error = std::sqrt(1.0 / 12 / 2000);
  CHECK(interval.low == Approx(interval.value - 1.96 * error).margin(0.15 * error));
  CHECK(interval.high == Approx(interval.value + 1.96 * error).margin(0.15 * error));
  int inside = 0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    std::vector<double> few;
    for (std::size_t k = 0; k < 60; ++k) few.push_back(random_unit(7, trial, k) < 0.3);
    const Interval found = bootstrap_mean(few, trial, 400);
    inside += found.low <= 0.3 && 0.3 <= found.high;
  }
  CHECK(inside >= 178);  // 95 % of 200 minus four standard deviations
}

TEST_CASE("the parts of the Brier score add up, and are known for hand-made forecasts") {
  const Made made = made_forecasts(500, 0.3, 0.7, 5);
  const BrierParts parts = brier_parts(made.p, made.happened, 10);
  CHECK(parts.reliability - parts.resolution + parts.uncertainty + parts.within_bins ==
        Approx(brier_score(made.p, made.happened)).epsilon(1e-13));
  // Two values, each a bin of its own: 0.8 with 3 of 4, 0.2 with 1 of 4.
  const std::vector<double> p = {0.2, 0.2, 0.2, 0.2, 0.8, 0.8, 0.8, 0.8};
  const std::vector<int> y = {0, 1, 0, 0, 1, 1, 0, 1};
  const BrierParts two = brier_parts(p, y, 2);
  CHECK(two.reliability == Approx(0.0025));
  CHECK(two.resolution == Approx(0.0625));
  CHECK(two.uncertainty == Approx(0.25));
  CHECK(two.within_bins == Approx(0).margin(1e-15));
}

TEST_CASE("the line of calibration finds offset and slope within its stated errors") {
  for (const auto& [offset, slope] : {std::pair(0.0, 1.0), std::pair(0.5, 0.6), std::pair(-0.4, 1.7)}) {
    int inside = 0;
    for (std::uint64_t trial = 0; trial < 60; ++trial) {
      const Made made = made_forecasts(800, offset, slope, 100 + trial);
      const CalibrationLine line = calibration_line(made.p, made.happened);
      inside += std::abs(line.slope - slope) < 1.96 * line.slope_error &&
                std::abs(line.offset - offset) < 1.96 * line.offset_error;
    }
    CHECK(inside >= 45);  // 90.25 % of 60 for two independent intervals, minus four standard deviations
  }
  CHECK(std::isinf(calibration_line(std::vector<double>{0.3, 0.3, 0.3}, std::vector<int>{0, 1, 0}).slope_error));
}

TEST_CASE("one power sharpens or blunts all outcomes, keeps their order, and the best one is found") {
  std::vector<double> p = {0.5, 0.3, 0.2};
  sharpen(p, 2);
  CHECK(p[0] == Approx(0.25 / 0.38));
  CHECK(p[2] == Approx(0.04 / 0.38));
  // Forecasts that were made overconfident by a power of 2.5: the cure is 1 / 2.5.
  std::vector<double> probability, weight;
  std::vector<std::size_t> outcome;
  for (std::size_t n = 0; n < 6000; ++n) {
    std::vector<double> row;
    for (std::size_t y = 0; y < 3; ++y) row.push_back(-std::log(1 - random_unit(4, n, y)));
    sharpen(row, 1);
    double u = random_unit(5, n, 0);
    std::size_t drawn = 0;
    while (drawn < 2 && u >= row[drawn]) u -= row[drawn++];
    sharpen(row, 2.5);
    probability.insert(probability.end(), row.begin(), row.end());
    outcome.push_back(drawn);
    weight.push_back(1);
  }
  CHECK(fit_power(probability, outcome, weight) == Approx(0.4).epsilon(0.06));
}
