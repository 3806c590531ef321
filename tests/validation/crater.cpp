// Craters: a ball dropped onto a bed of spheres.
#include <cmath>
#include <cstdio>
#include <vector>

#include "pipeline/bench/crater.h"
#include "tests/support/catch.h"
#include "tests/support/many.h"
#include "tests/support/measure.h"

using namespace gonogo;
using namespace gonogo::pipeline;
using namespace gonogo::test;

TEST_CASE("a ball that falls onto spheres sinks in with the third root of its fall") {
  std::vector<double> fall, depth;
  for (const double height : {0.2, 0.6, 1.8}) {
    CraterSpec spec;
    spec.tank.spheres = 5000;
    spec.tank.layers = 14;
    spec.drop_height = height;
    const ManyResult r = run_on_one_core(crater_scene(spec, 30, sim::Backend::cpu, 1));
    depth.push_back(std::log(value_of(r, "depth_m"))), fall.push_back(std::log(value_of(r, "total_fall_m")));
    std::printf("crater, dropped from %.1f m: depth %.4f m\n", height, std::exp(depth.back()));
  }
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < fall.size(); ++k)
    x += fall[k] / 3, y += depth[k] / 3, xx += fall[k] * fall[k] / 3, xy += fall[k] * depth[k] / 3;
  // Uehara et al. (2003).
  CHECK(agrees("crater, exponent of the depth over the fall [-]", 1.0 / 3, (xy - x * y) / (xx - x * x), 0.05));
}
