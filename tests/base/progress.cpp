// The time that work will still take.
#include "base/progress.h"

#include <cmath>

#include "tests/support/catch.h"

namespace gonogo {
namespace {

TEST_CASE("the time left follows from the items that this run did, and from other work that is to come") {
  CHECK(seconds_left({.total = 100, .done = 20, .elapsed = 40}) == Approx(160));
  CHECK(seconds_left({.total = 100, .done = 60, .reused = 40, .elapsed = 40}) == Approx(80));
  // 30 of the 40 s went into one of four parts that are not done item by item; three are to come.
  CHECK(seconds_left({.total = 100, .done = 20, .elapsed = 40, .other_elapsed = 30, .other_to_come = 90}) ==
        Approx(80 * 0.5 + 90));
  CHECK(seconds_left({.total = 100, .done = 100, .elapsed = 40}) == 0);
}

TEST_CASE("no time left is told before an item is done") {
  CHECK(std::isnan(seconds_left({.total = 100, .elapsed = 5})));
  CHECK(std::isnan(seconds_left({.total = 100, .done = 40, .reused = 40, .elapsed = 5})));
}

}  // namespace
}  // namespace gonogo
