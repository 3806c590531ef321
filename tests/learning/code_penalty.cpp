// Every word of a small layout is tried: code words keep their energies, all others pay.
#include "learning/encoding/layout.h"

#include <cmath>
#include <limits>

#include "base/math/random.h"
#include "learning/model/weights.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

constexpr double kFree = std::numeric_limits<double>::quiet_NaN();

/// 3 + 3 + 2 + 0 units, three outcomes.
VisibleLayout mixed_layout() {
  return VisibleLayout({Encoder::by_range("slope", "deg", Code::thermometer, 4, 0, 30),
                        Encoder::categorical("soil", {"sand", "loam", "clay"}),
                        Encoder::by_range("cohesion", "kPa", Code::gray, 4, 0, 8),
                        Encoder::by_range("load", "kN", Code::one_hot, 1, 5, 5)},
                       {"go", "slow", "no_go"});
}

Problem machine(const VisibleLayout& layout) {
  RbmWeights weights = RbmWeights::zeros(layout.unit_count(), 2);
  for (std::size_t k = 0; k < weights.weight.size(); ++k) weights.weight[k] = 4 * random_unit(3, 1, k) - 2;
  for (std::size_t k = 0; k < weights.visible_bias.size(); ++k) weights.visible_bias[k] = 2 * random_unit(3, 2, k) - 1;
  return to_qubo(weights, layout.unit_labels());
}

std::vector<std::int8_t> word(std::size_t number, std::size_t units) {
  std::vector<std::int8_t> row(units);
  for (std::size_t k = 0; k < units; ++k) row[k] = (number >> k) & 1;
  return row;
}

/// (1 - ones)^2, counted.
double one_hot_faults(std::span<const Bit> units) {
  double ones = 0;
  for (Bit u : units) ones += u;
  return (1 - ones) * (1 - ones);
}

}  // namespace

TEST_CASE("a penalty is nothing for code words and at least its strength for every other word") {
  const VisibleLayout layout = mixed_layout();
  const double strength = 2.5;
  const Problem plain = machine(layout);
  const std::vector<double> free(plain.variable_count(), kFree);
  const Problem fined = with_code_penalty(plain, layout, free, strength);
  check_problem(fined, "fined");
  CHECK(fined.labels == plain.labels);
  std::size_t valid = 0;
  for (std::size_t number = 0; number < std::size_t(1) << plain.variable_count(); ++number) {
    const auto row = word(number, plain.variable_count());
    const std::vector<Bit> visible(row.begin(), row.begin() + std::ptrdiff_t(layout.unit_count()));
    const double gaps = double(visible[1] > visible[0]) + double(visible[2] > visible[1]);
    const double faults =
        gaps + one_hot_faults(std::span(visible).subspan(3, 3)) + one_hot_faults(std::span(visible).subspan(8, 3));
    const double fine = energy(fined, row) - energy(plain, row);
    if (std::abs(fine - strength * faults) > 1e-12 || (faults == 0) != layout.decode(visible).valid) {
      INFO("word " << number);
      REQUIRE(fine == Approx(strength * faults));
      REQUIRE((faults == 0) == layout.decode(visible).valid);
    }
    valid += faults == 0;
  }
  CHECK(valid == 4 * 3 * 4 * 3 * 4);  // bins, outcomes, states of the hidden units
}

TEST_CASE("no penalty, no change; fixed units pay none; a strength that is none is refused") {
  const VisibleLayout layout = mixed_layout();
  const Problem plain = machine(layout);
  std::vector<double> fixed(plain.variable_count(), kFree);
  CHECK(with_code_penalty(plain, layout, fixed, 0) == plain);
  for (std::size_t k = 0; k < layout.unit_count(); ++k) fixed[k] = 0.5;  // a mean of words
  fixed[6] = fixed[7] = kFree;                                           // a Gray code's
  CHECK(clamp(with_code_penalty(plain, layout, fixed, 3), fixed) == clamp(plain, fixed));
  for (double strength : {-1.0, double(INFINITY), kFree})
    refused([&] { with_code_penalty(plain, layout, fixed, strength); }, "at least 0");
}
