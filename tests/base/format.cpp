// Numbers in messages.
#include "base/format.h"

#include <cmath>
#include <limits>

#include "tests/support/catch.h"

namespace gonogo {

TEST_CASE("a number in a message has the digits that a reader needs and no more") {
  CHECK(number_text(0.09) == "0.09");
  CHECK(number_text(-45) == "-45");
  CHECK(number_text(12.5) == "12.5");
  CHECK(number_text(2.0 / 3) == "0.667");
  CHECK(number_text(2.0 / 3, 6) == "0.666667");
  CHECK(number_text(0.00123456) == "0.00123");
  CHECK(number_text(0) == "0");
}

TEST_CASE("digits before the point are kept, and zeros among them") {
  CHECK(number_text(1230) == "1230");
  CHECK(number_text(123456.7) == "123457");
  CHECK(number_text(9999.96) == "10000");
  CHECK(number_text(9.996) == "10");
  CHECK(number_text(100) == "100");
}

TEST_CASE("very small and very large numbers have an exponent, NaN and infinity have names") {
  CHECK(number_text(2e-8) == "2e-08");
  CHECK(number_text(1.5e9) == "1.5e+09");
  CHECK(number_text(std::nan("")) == "NaN");
  CHECK(number_text(-std::numeric_limits<double>::infinity()) == "-infinity");
}

}  // namespace gonogo
