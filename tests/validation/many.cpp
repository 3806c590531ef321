// Many spheres together: how densely they pack, how a silo's wall carries them, how a ball floats on them, how far a
// column spreads.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "pipeline/lab/scenes/collapse.h"
#include "pipeline/lab/scenes/silo.h"
#include "pipeline/lab/scenes/tank.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/run_scene.h"

using namespace gonogo;
using namespace gonogo::lab;
using namespace gonogo::test;

namespace {

/// x of (1 - exp(-x)) / x = share, by halving.
double janssen_exponent(double share) {
  double low = 1e-6, high = 100;
  for (int k = 0; k < 100; ++k) {
    const double x = (low + high) / 2;
    ((1 - std::exp(-x)) / x > share ? low : high) = x;
  }
  return low;
}

}  // namespace

TEST_CASE("poured spheres pack at random: between loose and close packing") {
  TankSpec spec;
  spec.of.count = 4000;
  const double fraction = solid_fraction(spec, tank_world(spec, {}));
  // 0.55 to 0.64 are reported for friction from much to none; settled at friction 0.1.
  CHECK(agrees("random packing, solid fraction [-]", 0.61, fraction, 0.03));
}

TEST_CASE("a silo's floor carries what Janssen says, with one ratio of stresses for fills of any height") {
  std::vector<double> ratio, by_stress;
  for (const int slenderness : {1, 2, 3}) {
    SiloSpec spec;
    spec.of.count = 1000 * slenderness;
    spec.slenderness = slenderness;
    spec.flow_time = 0.03;
    const ManyResult r = run_on_one_core(silo_scene(spec, {.iterations = 50}));
    const double share = value_of(r, "floor_share_of_weight"), fill = value_of(r, "fill_over_width");
    // x = 4 mu K H / D.
    ratio.push_back(janssen_exponent(share) / (4 * spec.of.friction * fill));
    by_stress.push_back(value_of(r, "wall_friction_mobilised") * value_of(r, "wall_stress_ratio"));
    std::printf(
        "silo, fill %.2f of its width: floor carries %.3f of the weight, K %.3f; at the wall friction %.3f mobilised, "
        "stresses %.3f\n",
        fill, share, ratio.back(), value_of(r, "wall_friction_mobilised"), value_of(r, "wall_stress_ratio"));
  }
  const auto [low, high] = std::minmax_element(ratio.begin(), ratio.end());
  const double mean = (ratio[0] + ratio[1] + ratio[2]) / 3;
  // Published: 0.5 to 0.8.
  CHECK(agrees("Janssen, ratio of stresses [-]", 0.65, mean, 0.15));
  CHECK(agrees("Janssen, largest over smallest ratio [-]", 1, *high / *low, 0.15));
  // Janssen's K mu is what the wall's forces say themselves: mobilised friction times the ratio of stresses.
  for (std::size_t k = 0; k < ratio.size(); ++k)
    CHECK(agrees("Janssen, K over that of the wall's forces [-]", 1, ratio[k] / by_stress[k], 0.12));
}

TEST_CASE("a ball on smooth spheres floats as deep as on a fluid of their bulk density") {
  for (const double density : {0.3, 0.7}) {
    BallSpec spec;
    spec.tank.of.count = 2500;
    spec.size_ratio = 6;
    spec.relative_density = density;
    spec.floated = 1.5;
    const ManyResult r = run_on_one_core(ball_scene(spec, {.iterations = 40}));
    // The surface is known to a third of a sphere, a twentieth of the ball's volume; spheres do not fill the gap
    // around the ball.
    CHECK(agrees("floating ball, share of its volume below the surface [-]", density, value_of(r, "sunk_share"), 0.12));
  }
}

TEST_CASE(
    "a column that falls apart spreads in proportion to its height; measured run-outs lie inside of its frayed rim") {
  std::vector<double> slope;
  for (const double aspect : {0.6, 1.0}) {
    CollapseSpec spec;
    spec.of.count = 2000;
    spec.aspect = aspect;
    const ManyResult r = run_on_one_core(collapse_scene(spec, {.iterations = 30}));
    const double a = value_of(r, "aspect"), heap = value_of(r, "run_out_covered"),
                 all = value_of(r, "run_out_of_99_in_100");
    // Lube et al. (2004), a < 1.7: 1.24 a, of columns hundreds of grains wide. Here the column is 16 wide and its rim
    // frays: the measured run-out lies between that of the heap and that of its stragglers. The heap's comes nearer
    // with more spheres (docs/validation.md).
    std::printf(
        "column collapse, height over radius %.3f: run-out of the heap %.3f, of 99 in 100 %.3f; measured 1.24 a = "
        "%.3f\n",
        a, heap, all, 1.24 * a);
    CHECK(heap < 1.24 * a);
    CHECK(all > 1.24 * a);
    slope.push_back(heap / a);
  }
  CHECK(agrees("column collapse, slopes of the run-out, one over the other [-]", 1, slope[1] / slope[0], 0.25));
}
