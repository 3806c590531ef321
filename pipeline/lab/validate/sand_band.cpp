#include "pipeline/lab/validate/sand_band.h"

#include <algorithm>

#include "base/units.h"
#include "vehicle/semi_empirical/bekker_wong.h"
#include "vehicle/semi_empirical/traction.h"

namespace gonogo::lab {
namespace {

/// Dry sand of the Land Locomotion Laboratory and LETE sand (Wong, Theory of Ground Vehicles, table of terrain values;
/// configs/soils); shear displacement K of sands, 10 to 25 mm there.
struct BekkerSand {
  double n, k_c, k_phi, cohesion;  // [N/m^(n+1)], [N/m^(n+2)], [Pa]
};
constexpr BekkerSand kSand[] = {{1.1, 0.99e3, 1528.43e3, 1040}, {0.793, 102e3, 5301e3, 1300}};
constexpr double kShear[] = {0.010, 0.025};
/// Cone index of dry sand at tyre depth, loose to dense [Pa]: 30 to 150 psi, the range in which Turnage's and Mason's
/// sand data lie.
constexpr double kConeIndex[] = {207e3, 414e3, 1034e3};

void widen(double (&range)[2], double x) {
  range[0] = std::min(range[0], x);
  range[1] = std::max(range[1], x);
}

void add_wong_reece(const WheelOnSand& w, double friction_angle, double cohesion, TractionBand& band) {
  for (const BekkerSand& sand : kSand)
    for (const double shear : kShear)
      for (const double c : {0.0, sand.cohesion, cohesion}) {
        const vehicle::BekkerSoil soil{.n = sand.n,
                                       .k_c = sand.k_c,
                                       .k_phi = sand.k_phi,
                                       .cohesion = c,
                                       .friction_angle = friction_angle * kDegree,
                                       .shear_modulus = shear};
        const vehicle::WheelForces f = vehicle::wheel_forces_under(soil, w.radius, w.width, band.slip, w.load);
        const double pull = f.drawbar_pull / w.load;
        widen(band.pull, pull);
        widen(band.resistance, f.torque / w.radius / w.load - pull);
      }
}

void add_cone_index(const WheelOnSand& w, TractionBand& band) {
  for (const double index : kConeIndex) {
    // Contact pressure of the mobility index: load over width times radius.
    const double ratio = w.load / (w.width * w.radius) / index;
    if (ratio < vehicle::kMinPressureRatio) continue;
    const double net = vehicle::sand_net_traction(ratio, band.slip);
    widen(band.pull, net);
    if (!(w.section_height > 0)) continue;
    const vehicle::WheelOnSoil on{.load = w.load,
                                  .diameter = 2 * w.radius,
                                  .width = w.width,
                                  .section_height = w.section_height,
                                  .deflection = w.deflection,
                                  .cone_index = index};
    widen(band.resistance, vehicle::sand_gross_traction(vehicle::sand_numeric(on), band.slip) - net);
  }
}

}  // namespace

TractionBand sand_band(const WheelOnSand& wheel, double friction_angle, double slip, double cohesion) {
  TractionBand band{slip, {1e9, -1e9}, {1e9, -1e9}};
  add_wong_reece(wheel, friction_angle, cohesion, band);
  add_cone_index(wheel, band);
  return band;
}

}  // namespace gonogo::lab
