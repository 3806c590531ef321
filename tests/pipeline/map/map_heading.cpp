// Headings: slopes along and across, tables over both, worst and best of all headings, measures that depend on them.
#include <algorithm>
#include <cmath>

#include "base/math/random.h"
#include "base/units.h"
#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/evaluate/soil_response.h"
#include "tests/pipeline/map/analytic_model.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;

namespace {

std::size_t index(const char* name) { return contract().variable_index(name); }

/// P(go) falls with the slope along and, half as fast, with the slope across.
double made_p_go(double along, double across) { return 1 / (1 + std::exp((along + 0.5 * std::abs(across) - 18) / 3)); }

OutcomeModel made_model() {
  OutcomeModel model = test::AnalyticModel{}.outcome_model();
  model.sampled[index("slope_along")] = {-20, 30};
  model.sampled[index("slope_across")] = {-15, 15};
  model.probabilities = [](std::span<const double> points, std::span<double> result) {
    const std::size_t width = contract().variables.size(), outcomes = contract().outcomes.size();
    std::fill(result.begin(), result.end(), 0.0);
    for (std::size_t i = 0; i * width < points.size(); ++i) {
      const double p = made_p_go(points[i * width + index("slope_along")], points[i * width + index("slope_across")]);
      result[i * outcomes + contract().outcome_index(Verdict::go, Reason::none)] = p;
      result[i * outcomes + contract().outcome_index(Verdict::no_go, Reason::traction)] = 1 - p;
    }
  };
  return model;
}

SoilResponse made_response() {
  return SoilResponse(made_model(), MapRules{}, {std::vector<double>(contract().variables.size(), NAN)});
}

double to_half(double x) { return std::round(2 * x) / 2; }

}  // namespace

TEST_CASE("slopes along and across a heading are those of gravity in the frame of the bed") {
  for (double slope = 0; slope < 80; slope += 7)
    for (double psi = -180; psi <= 180; psi += 15) {
      // Gravity of docs/notation.md: -g (sin s cos psi, sin s sin psi, cos s).
      const double x = std::sin(slope * kDegree) * std::cos(psi * kDegree),
                   y = std::sin(slope * kDegree) * std::sin(psi * kDegree), z = std::cos(slope * kDegree);
      const BedSlopes slopes = bed_slopes(slope, psi * kDegree);
      CHECK(std::tan(slopes.along * kDegree) == Approx(x / z).margin(1e-12));
      CHECK(std::tan(slopes.across * kDegree) == Approx(y / z).margin(1e-12));
    }
}

TEST_CASE("heading north on ground that falls east has its left side up; heading west it goes uphill") {
  const BedSlopes north = bed_slopes(10, fall_line_angle(0, 90)), west = bed_slopes(10, fall_line_angle(270, 90));
  CHECK(north.along == Approx(0).margin(1e-9));
  CHECK(north.across == Approx(10));
  CHECK(west.along == Approx(10));
  CHECK(west.across == Approx(0).margin(1e-9));
}

TEST_CASE("P(go) of any heading is the model's own at slopes rounded to half a degree, and unknown outside the box") {
  const SoilResponse soil = made_response();
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const double slope = rounded_slope(45 * random_unit(3, 0, std::uint64_t(i)));
    const double psi = 2 * kPi * random_unit(3, 1, std::uint64_t(i));
    const HeadingAnswer& answer = soil.at(slope, psi);
    const BedSlopes slopes = bed_slopes(slope, psi);
    const double along = to_half(slopes.along), across = to_half(slopes.across);
    if (along >= -20 && along <= 30 && std::abs(across) <= 15) {
      CHECK(answer.p_go == Approx(made_p_go(along, across)).margin(1e-6));
      ++inside;
    } else {
      CHECK(std::isnan(answer.p_go));
      CHECK(answer.result.verdict == (along > 30 && std::abs(across) <= 15 ? Verdict::no_go : Verdict::unknown));
    }
  }
  CHECK(inside > 500);
}

TEST_CASE("worst and best over the headings are those of a search over all of them") {
  const SoilResponse soil = made_response();
  for (double slope = 0; slope <= 40; slope += 0.75) {
    double worst = 2, best = -1;
    bool unknown = false, no_go = false, go = false;
    for (int h = 0; h < 36; ++h) {
      const BedSlopes slopes = bed_slopes(slope, h * 10 * kDegree);
      const double along = to_half(slopes.along), across = to_half(slopes.across);
      if (along > 30 && std::abs(across) <= 15)
        no_go = true;
      else if (along < -20 || along > 30 || std::abs(across) > 15)
        unknown = true;
      else {
        const double p = made_p_go(along, across);
        worst = std::min(worst, p);
        best = std::max(best, p);
        no_go = no_go || p < 0.5;
        go = go || p >= 0.8;
      }
    }
    const HeadingRange& range = soil.at(slope).headings;
    INFO("slope " << slope);
    CHECK((range.worst.verdict == Verdict::no_go) == no_go);
    if (!no_go) CHECK((range.worst.verdict == Verdict::unknown) == unknown);
    CHECK((range.best.verdict == Verdict::go) == go);
    if (best >= 0) {
      CHECK(range.p_worst == Approx(worst).margin(1e-6));
      CHECK(range.p_best == Approx(best).margin(1e-6));
    }
  }
}

TEST_CASE("the interval on P(go) holds what the slope's error makes of it") {
  const OutcomeModel model = made_model();
  const double error = 0.02;  // rise per metre
  const SoilResponse soil(model, MapRules{}, {std::vector<double>(contract().variables.size(), NAN)}, error);
  const SoilResponse certain = made_response();
  for (const double slope : {5.0, 12.0, 18.0, 22.0}) {
    const CellAnswer& answer = soil.at(slope);
    // One soil: quantiles of P(go) are P(go) at quantiles of the rise, the outermost of nine parts here.
    const double rise = std::tan(slope * kDegree);
    const auto at = [&](double z) { return made_p_go(std::atan(rise + z * error) / kDegree, 0); };
    CHECK(answer.p_low == Approx(at(1.59322)).margin(2e-3));
    CHECK(answer.p_high == Approx(at(-1.59322)).margin(2e-3));
    CHECK(certain.at(slope).p_low == certain.at(slope).p_high);
  }
  CHECK(soil.at(45).p_low == 0);
  CHECK(soil.at(45).p_high < 0.05);  // no wall is easier than the steepest slope that was sampled
}

TEST_CASE("a quadratic measure is found again, unknown variables at their mean, and noise is not fitted") {
  const std::size_t width = contract().variables.size(), rows = 120;
  std::vector<double> points(rows * width), value, noise;
  const auto truth = [](double along, double payload) {
    return 2 - 0.03 * along - 0.001 * along * along - payload / 4000;
  };
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t v = 0; v < width; ++v) points[i * width + v] = 1;
    const double along = -20 + 50 * random_unit(4, 0, i), payload = 1000 * random_unit(4, 1, i);
    points[i * width + index("slope_along")] = along;
    points[i * width + index("payload")] = payload;
    value.push_back(truth(along, payload));
    noise.push_back(random_unit(4, 2, i));
  }
  const MeasureFit fit = fit_measure("mean_speed", "m/s", points, value);
  std::vector<double> point(width, 1.0);
  point[index("slope_along")] = 12;
  point[index("payload")] = 300;
  CHECK(fit.value(point) == Approx(truth(12, 300)).margin(0.01));
  CHECK(fit.error < 0.02 * fit.spread + 0.01);
  const SlopeMeasure soil = on_soil(fit, {point});
  for (const double along : {-10.0, 0.0, 20.0}) {
    point[index("slope_along")] = along;
    CHECK(soil.at({along, 1}) == Approx(fit.value(point)).margin(1e-9));
  }
  double mean = 0;
  for (std::size_t i = 0; i < rows; ++i) mean += points[i * width + index("payload")] / double(rows);
  point[index("payload")] = NAN;
  CHECK(fit.value(point) == Approx(truth(20, mean)).margin(0.01));
  const MeasureFit nothing = fit_measure("noise", "1", points, noise);
  CHECK(nothing.error >= 0.9 * nothing.spread);
}

TEST_CASE("a heading of a map is uphill, worst, best or an azimuth, and nothing else") {
  MapRules rules;
  set_heading(rules, "45.5", "test");
  CHECK(rules.heading_mode == HeadingMode::set);
  CHECK(heading_text(rules) == "heading 45.5 degrees from grid north");
  for (const char* bad : {"", "north", "360", "-1", "nan", "10 "})
    CHECK(
        contains(input_error([&] { set_heading(rules, bad, "map: --heading"); }), "is no heading; use uphill, worst"));
}
