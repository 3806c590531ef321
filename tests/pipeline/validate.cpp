// What the validation commands compute around their trials.
#include <cmath>

#include "pipeline/validate/drawbar.h"
#include "tests/support/catch.h"
#include "tests/support/vehicles.h"
#include "vehicle/model/statics.h"
#include "vehicle/semi_empirical/bekker_wong.h"
#include "vehicle/semi_empirical/traction.h"

namespace gonogo::pipeline {

TEST_CASE("means of replicates carry their standard errors") {
  const MeanOf m = mean_of({1, 2, 3, 4});
  CHECK(m.mean == 2.5);
  CHECK(m.error == Approx(std::sqrt(5.0 / 3 / 4)));
  CHECK(mean_of({7}).error == 0);
}

TEST_CASE("the band of drawbar pulls on sand holds every formula that makes it and is bounded by friction") {
  const vehicle::Vehicle v = test::shipped_vehicle("hmmwv");
  const double angle = 32, load = vehicle::weigh(v).total * vehicle::kGravity / 4;
  const vehicle::BekkerSoil dry{1.1, 0.99e3, 1528.43e3, 0, angle * 3.14159265358979 / 180, 0.025};
  double before = -1;
  for (const double slip : {0.05, 0.2, 0.5, 0.9}) {
    const TractionBand b = sand_band(v, angle, slip);
    const auto inside = [](const double(&range)[2], double x) { return x >= range[0] - 1e-6 && x <= range[1] + 1e-6; };
    const vehicle::WheelForces f = vehicle::wheel_forces_under(dry, 0.467, 0.254, slip, load);
    CHECK(inside(b.pull, f.drawbar_pull / load));
    CHECK(inside(b.resistance, f.torque / 0.467 / load - f.drawbar_pull / load));
    const double ratio = load / (0.254 * 0.467) / 414e3;
    if (ratio >= vehicle::kLeastPressureRatio) CHECK(inside(b.pull, vehicle::sand_net_traction(ratio, slip)));
    CHECK(b.pull[0] < b.pull[1]);
    // No wheel without lugs pulls more than friction and the cohesion of its footprint give.
    CHECK(b.pull[1] < std::tan(angle * 3.14159265358979 / 180) + 0.1);
    CHECK(b.pull[1] > before);
    before = b.pull[1];
  }
}

}  // namespace gonogo::pipeline
