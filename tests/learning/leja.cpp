#include "learning/model/leja.h"

#include <cmath>
#include <vector>

#include "tests/support/catch.h"

using namespace gonogo::learning;

TEST_CASE("a Leja term is 1 at its node and 0 at those before and nowhere larger than 1") {
  for (int k = 0; k < kLejaCount; ++k) {
    std::vector<double> terms(std::size_t(k) + 1);
    for (int m = 0; m <= k; ++m) {
      leja_terms(leja_point(m), terms);
      CHECK(terms[std::size_t(k)] == Approx(m == k ? 1 : 0).margin(1e-12));
    }
    double most = 0;
    for (int i = 0; i <= 4000; ++i) {
      leja_terms(i / 4000., terms);
      most = std::max(most, std::abs(terms[std::size_t(k)]));
    }
    CHECK(most <= 1 + 1e-9);
  }
}

TEST_CASE("Leja points are both ends and the middle and then roots of derivatives") {
  CHECK(leja_point(0) == 0);
  CHECK(leja_point(1) == 1);
  CHECK(leja_point(2) == Approx(0.5).epsilon(1e-6));
  // t (t - 1) (t - 1/2) has its extremes at 1/2 +- 1 / sqrt(12).
  CHECK(std::abs(leja_point(3) - 0.5) == Approx(1 / std::sqrt(12.)).epsilon(1e-6));
}

TEST_CASE("surpluses of a polynomial end at its degree and give it back") {
  const auto f = [](double t) { return 3 - 2 * t + std::pow(t, 4) - 0.7 * std::pow(t, 6); };
  std::vector<double> surplus, terms(kLejaCount);
  for (int k = 0; k < kLejaCount; ++k) {
    leja_terms(leja_point(k), terms);
    double rest = f(leja_point(k));
    for (std::size_t m = 0; m < surplus.size(); ++m) rest -= surplus[m] * terms[m];
    surplus.push_back(rest);
    if (k > 6) CHECK(std::abs(rest) < 1e-12);
  }
  for (const double t : {0.03, 0.4, 0.71, 0.99}) {
    leja_terms(t, terms);
    double sum = 0;
    for (std::size_t m = 0; m < surplus.size(); ++m) sum += surplus[m] * terms[m];
    CHECK(sum == Approx(f(t)).epsilon(1e-12));
  }
}
