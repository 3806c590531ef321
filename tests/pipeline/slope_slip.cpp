// The measure of the slope-slip validation, on the published simulation; the figure's bounds.
#include "pipeline/validate/slope_slip.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace gonogo::pipeline;

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
