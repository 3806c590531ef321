// Measures of the validations of MGRU3 on its simulants, on what others published; the figures' bounds.
#include "pipeline/lab/validate/slope_slip.h"

#include <algorithm>
#include <cmath>

#include "pipeline/lab/validate/given_slip.h"
#include "tests/support/catch.h"

using namespace gonogo::report;
using namespace gonogo::campaign;
using namespace gonogo::lab;

TEST_CASE("the published simulation has the slip error that was computed from its table by hand") {
  const auto published = published_slope_slips();
  REQUIRE(published.size() == 6);
  CHECK(rms_slip_error(published) == Approx(0.094).epsilon(0.01));
  CHECK(rms_slip_error(published, 15) == Approx(0.050).epsilon(0.02));
}

TEST_CASE("a wheel that slips as in the experiment keeps all bounds, one that could not be simulated none") {
  auto points = published_slope_slips();
  for (SlopeSlip& p : points) p.slip = p.measured;
  const SoilFigure good = slope_slip_figure({}, points);
  REQUIRE(good.check.size() == 2);
  CHECK(good.check[0].key == "rmse_slip_mgru3");
  for (const SoilCheck& c : good.check) CHECK(c.holds());
  CHECK(good.over_time == "slope_deg,second,slip\n");
  points[1].over_time = {0.25, 0.5};
  CHECK(slope_slip_figure({}, points).over_time == "slope_deg,second,slip\n5.24,1,0.2500\n5.24,2,0.5000\n");
  points[0].slip = std::nan("");
  for (const SoilCheck& c : slope_slip_figure({}, points).check) CHECK_FALSE(c.holds());
}

TEST_CASE("the tests of 2022 repeat those of 2021 to a mean square of slips that was computed by hand") {
  const auto repeated = repeated_slope_slips();
  REQUIRE(repeated.size() == 6);
  CHECK(repeated[0].slip == Approx(0.0251));                          // below the first slope: the first slip
  CHECK(repeated[3].slip == Approx(0.1043 + 4.93 / 5.277 * 0.2508));  // between two
  CHECK(rms_slip_error(repeated) == Approx(0.046).epsilon(0.02));
}

TEST_CASE("the rover's figure has keys of its own beside the wheel's") {
  SimulantRun rover;
  rover.vehicle = kSimulantRover;
  const SoilFigure f = slope_slip_figure(rover, published_slope_slips());
  CHECK(f.name == "soils_mgru3_rover");
  REQUIRE(f.check.size() == 2);
  CHECK(f.check[0].key == "rmse_slip_mgru3_rover");
  CHECK(f.check[1].key == "rmse_slip_mgru3_rover_to_15deg");
}

TEST_CASE("slip over the grousers and slip of the rim are each other's inverse") {
  const Rim rim{0.225, 0.025};
  CHECK(rim.slip_over_grousers(0) == Approx(0.1));    // the rim rolls, the circle over the grousers slips
  CHECK(rim.slip_of_rim(0) == Approx(1 - 10.0 / 9));  // and the other way round
  for (const double slip : {-0.2, 0.0, 0.4, 1.0}) CHECK(rim.slip_of_rim(rim.slip_over_grousers(slip)) == Approx(slip));
}

TEST_CASE("the single-wheel tests' means lie between them and are no farther apart than they scatter") {
  const auto tests = measured_traction();
  REQUIRE(tests.size() == 10);
  double widest = 0;
  for (const GivenSlip& t : tests) {
    CHECK(t.lowest <= t.measured);
    CHECK(t.measured <= t.highest);
    widest = std::max(widest, t.highest - t.lowest);
  }
  CHECK(tests[2].measured == Approx((13.82 + 16.93) / 2));
  CHECK(rms_traction_error(tests) == 0);
  const SoilFigure good = given_slip_figure({}, tests);
  REQUIRE(good.check.size() == 1);
  CHECK(good.check[0].key == "rmse_traction_slope_trec_deg");
  CHECK(good.check[0].high == Approx(widest));
  CHECK(good.check[0].holds());
  auto failed = tests;
  failed[4].traction_slope = std::nan("");
  CHECK_FALSE(given_slip_figure({}, failed).check[0].holds());
}
