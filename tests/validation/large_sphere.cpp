// One large sphere among many: how deep it falls into them, and that it rises when they are shaken.
#include <cmath>
#include <cstdio>
#include <vector>

#include "pipeline/lab/scenes/tank.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/run_scene.h"

using namespace gonogo;
using namespace gonogo::lab;
using namespace gonogo::test;

TEST_CASE("a ball that falls onto spheres sinks in with the third root of its fall") {
  std::vector<double> fall, depth;
  for (const double height : {0.2, 0.6, 1.8}) {
    CraterSpec spec;
    spec.tank.of.count = 5000;
    spec.tank.layers = 14;
    spec.drop_height = height;
    const ManyResult r = run_on_one_core(crater_scene(spec, {.iterations = 30}));
    depth.push_back(std::log(value_of(r, "depth_m")));
    fall.push_back(std::log(value_of(r, "total_fall_m")));
    std::printf("crater, dropped from %.1f m: depth %.4f m\n", height, std::exp(depth.back()));
  }
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < fall.size(); ++k) {
    x += fall[k] / 3;
    y += depth[k] / 3;
    xx += fall[k] * fall[k] / 3;
    xy += fall[k] * depth[k] / 3;
  }
  // Uehara et al. (2003).
  CHECK(agrees("crater, exponent of the depth over the fall [-]", 1.0 / 3, (xy - x * y) / (xx - x * x), 0.05));
}

TEST_CASE("a large sphere rises through small ones that are shaken, and stays in a tank at rest") {
  NutSpec spec;
  spec.tank.of.count = 1000;
  const ManyResult shaken = run_on_one_core(nut_scene(spec, {.iterations = 25}));
  spec.acceleration = 0;
  spec.shaken = 1;
  const ManyResult still = run_on_one_core(nut_scene(spec, {.iterations = 25}));
  const double start = value_of(shaken, "height_over_depth_start");
  // The fill sinks a little into the room of the spheres that the large one replaced.
  // Brazil nut: from the floor, where its centre is at a quarter of the depth, to the surface.
  CHECK(agrees("large sphere, height over depth after 10 s of 3 g at 5 Hz [-]", 1,
               value_of(shaken, "height_over_depth_end"), 0.2));
  CHECK(agrees("the same at rest for 1 s [-]", start, value_of(still, "height_over_depth_end"), 0.08));
}
