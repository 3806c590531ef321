// Semi-empirical forecasts of vehicles: against the relation of one wheel where all wheels are alike, and in the
// directions that are known.
#include "pipeline/map/rivals.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "pipeline/campaign/study/contract.h"
#include "terrain/soil/soil.h"
#include "tests/support/catch.h"
#include "vehicle/family/numbers.h"
#include "vehicle/semi_empirical/traction.h"

using namespace gonogo;
using namespace gonogo::map;

namespace {

std::vector<double> point_of(double slope, double power = 3, double cohesion = 8, double load = 1, double width = 0.3) {
  std::vector<double> x(campaign::contract().variables.size(), 0);
  const auto set = [&](const char* name, double value) { x[campaign::contract().variable_index(name)] = value; };
  set("slope_along", slope);
  set("friction_angle", 30);
  set("tyre_friction", 0.8);
  set("cohesion", cohesion);
  set("load_number", load);
  set("width_ratio", width);
  set("deflection_ratio", 0.04);
  set("axles", 2);
  set("axle_gap_ratio", 2);
  set("centre_height_ratio", 0.8);
  set("centre_share", 0.5);
  set("clearance_ratio", 0.5);
  set("force_number", 2);
  set("power_number", power);
  set("commanded_speed", 2);
  return x;
}

std::size_t place(const char* name) {
  return std::size_t(std::find(rival_names().begin(), rival_names().end(), name) - rival_names().begin());
}

}  // namespace

TEST_CASE("on level ground a vehicle of equal wheels pulls as one of them") {
  const double load = 1 * vehicle::kFamilyDensity * kGravity * 0.3;
  const vehicle::WheelOnSoil wheel{.load = load,
                                   .diameter = 1,
                                   .width = 0.3,
                                   .section_height = 0.225,
                                   .deflection = 0.04,
                                   .cone_index = terrain::cone_index(8e3, 30)};
  const std::vector<double> margins = rival_margins(point_of(0), 1);
  CHECK(margins[place("cone_index")] == Approx(vehicle::brixius(wheel, 0.4, true).net()).margin(0.03));
  CHECK(margins[place("drove_clay")] == Approx(vehicle::clay_traction(wheel, 0.7).net()));
}

TEST_CASE("all relations lose by slope, and none pulls more than the driveline") {
  for (std::size_t k = 0; k < rival_names().size(); ++k) {
    INFO(rival_names()[k]);
    CHECK(rival_margins(point_of(20), 1)[k] < rival_margins(point_of(5), 1)[k]);
    CHECK(rival_margins(point_of(0, 0.05), 1)[k] == Approx(0.05 / (2 / std::sqrt(kGravity))));
  }
}

TEST_CASE("a vehicle below its cone index of one pass is no-go by that relation, at any slope") {
  CHECK(rival_margins(point_of(0, 3, 8), 1)[place("cone_index")] > 0);
  CHECK(rival_margins(point_of(0, 3, 0, 5, 0.2), 1)[place("cone_index")] == -1);
}
