// R-hat and effective sample size against known autocorrelations and against ArviZ.
#include "learning/score/mixing.h"

#include <cmath>

#include "base/math/random.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

/// Chains of x_n = rho x_(n-1) + noise of variance 1 - rho^2, from their distribution.
std::vector<double> autoregressive(std::size_t chains, std::size_t draws, double rho, std::uint64_t seed) {
  std::vector<double> result;
  for (std::size_t c = 0; c < chains; ++c) {
    double x = random_normal(seed, c, 0);
    for (std::size_t n = 1; n <= draws; ++n) {
      result.push_back(x);
      x = rho * x + std::sqrt(1 - rho * rho) * random_normal(seed, c, n);
    }
  }
  return result;
}

/// The same numbers as in the comparison with ArviZ.
std::vector<double> waves(std::size_t chains, std::size_t draws) {
  std::vector<double> result;
  for (std::size_t c = 0; c < chains; ++c)
    for (std::size_t n = 0; n < draws; ++n)
      result.push_back(std::sin(0.07 * double(n) + double(c)) +
                       std::sin(1.3 * double(n) * double(n) + 2.1 * double(c)) + 0.15 * double(c));
  return result;
}

}  // namespace

TEST_CASE("quantiles of the normal distribution invert its distribution function") {
  for (const double p : {1e-300, 1e-12, 0.001, 0.3, 0.5, 0.77, 0.999, 1 - 1e-12}) {
    const double x = normal_quantile(p);
    if (p <= 0.5)
      CHECK(std::erfc(-x / std::sqrt(2.0)) / 2 == Approx(p).epsilon(1e-11));
    else
      CHECK(std::erfc(x / std::sqrt(2.0)) / 2 == Approx(1 - p).epsilon(1e-11));
  }
  CHECK(normal_quantile(0.975) == Approx(1.959963984540054).epsilon(1e-13));
}

TEST_CASE("independent and autoregressive chains have the effective sizes that theory gives") {
  for (const double rho : {0.0, 0.5, 0.8, -0.3}) {
    const Mixing m = mixing(autoregressive(4, 10'000, rho, 3), 4);
    CHECK(m.effective == Approx(40'000 * (1 - rho) / (1 + rho)).epsilon(0.08));
    CHECK(m.r_hat < 1.01);
    CHECK(m.r_hat > 0.999);
  }
}

TEST_CASE("chains that differ in place, in spread or between their halves have an R-hat above 1") {
  std::vector<double> place = autoregressive(4, 500, 0, 1), spread = place, drift = place;
  for (std::size_t n = 0; n < 500; ++n) {
    place[n] += 1;
    spread[n] *= 4;
  }
  for (std::size_t n = 0; n < drift.size(); ++n) drift[n] += n % 500 < 250 ? 0 : 1;
  CHECK(mixing(place, 4).r_hat > 1.05);
  CHECK(mixing(spread, 4).r_hat > 1.05);
  CHECK(mixing(drift, 4).r_hat > 1.05);
  CHECK(mixing(place, 4).effective < 100);
}

TEST_CASE("both numbers are those of ArviZ 0.23.4 (rhat rank, ess bulk)") {
  CHECK(mixing(waves(4, 50), 4).r_hat == Approx(1.2278583999249394).epsilon(1e-10));
  CHECK(mixing(waves(4, 50), 4).effective == Approx(14.084063401293195).epsilon(1e-10));
  CHECK(mixing(waves(3, 101), 3).r_hat == Approx(1.0821233841859395).epsilon(1e-10));
  CHECK(mixing(waves(3, 101), 3).effective == Approx(26.31317446691589).epsilon(1e-10));
  CHECK(mixing(waves(1, 40), 1).effective == Approx(7.671518450000212).epsilon(1e-10));
  std::vector<double> ties = waves(4, 50);
  for (double& x : ties) x = std::floor(2 * x);
  CHECK(mixing(ties, 4).r_hat == Approx(1.2134532607782047).epsilon(1e-10));
  CHECK(mixing(ties, 4).effective == Approx(14.902469609017121).epsilon(1e-10));
}

TEST_CASE("what says nothing has no R-hat") {
  CHECK(std::isnan(mixing(std::vector<double>(40, 2.0), 4).r_hat));
  CHECK(std::isnan(mixing(std::vector<double>{1, 2, 3, 4, 5, 6}, 2).r_hat));
  CHECK(std::isnan(mixing(std::vector<double>{1, 2, 3}, 2).effective));
}
