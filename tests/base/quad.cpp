#include "base/math/quad.h"

#include <cmath>
#include <vector>

#include "base/math/random.h"
#include "tests/support/catch.h"

using namespace gonogo;

TEST_CASE("exponentials lie within two units in the last place, in lists of any length") {
  for (std::size_t count = 0; count <= 9; ++count) {
    std::vector<double> x(count);
    for (std::size_t k = 0; k < count; ++k) x[k] = random_normal(3, count, k);
    std::vector<double> found = x;
    take_exponentials(found);
    for (std::size_t k = 0; k < count; ++k) CHECK(found[k] == Approx(std::exp(x[k])).epsilon(1e-15));
  }
  double worst = 0;
  for (std::size_t k = 0; k < 100'000; ++k) {
    const double x = 1400 * random_unit(4, 1, k) - 700;
    const double found = exponential(Quad{x, 0, 0, 0})[0];
    worst = std::max(worst, std::abs(found / std::exp(x) - 1));
  }
  CHECK(worst < 4.5e-16);
}

TEST_CASE("exponentials beyond the bounds are those at the bounds, and neighbours do not matter") {
  const Quad far = exponential(Quad{1e4, -1e4, 0, 1});
  CHECK(far[0] == exponential(Quad{700, 2, 3, 4})[0]);
  CHECK(far[1] == exponential(Quad{-700, 2, 3, 4})[0]);
  CHECK(far[2] == 1);
  CHECK(far[3] == exponential(Quad{1, -5, 600, 2})[0]);
}
