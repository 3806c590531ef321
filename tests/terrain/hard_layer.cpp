// Shallow beds cut from a deep packing: what is left of it, and that it stands on its hard layer.
#include "terrain/bed/bed.h"

#include <algorithm>
#include <cmath>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::terrain;
using gonogo::test::agrees;

namespace {

const Packing& deep() {
  static const Packing packing = [] {
    BedSpec s;
    s.length = 0.9;
    s.width = 0.72;
    s.depth = 0.6;
    s.grain_diameter = 0.1;
    return settle_packing(s, 1);
  }();
  return packing;
}

}  // namespace

TEST_CASE("a bed on a hard layer has the grains above it at their distances, and a base without a grain above z = 0") {
  const double depth = 0.3;
  const Packing bed = on_hard_layer(deep(), depth);
  const double top = deep().surface - depth;
  std::size_t above = 0;
  for (const Grain& g : deep().grain) above += g.position.z >= top;
  REQUIRE(bed.grain.size() == above);
  CHECK(above > 0.4 * double(deep().grain.size()));
  CHECK(above < 0.6 * double(deep().grain.size()));
  std::size_t k = 0;
  for (const Grain& g : deep().grain)
    if (g.position.z >= top) {
      CHECK(bed.grain[k].position.z == g.position.z - top);
      CHECK(bed.grain[k++].radius == g.radius);
    }
  for (const Grain& g : bed.base) CHECK(g.position.z < 0);
  CHECK(bed.surface == depth);
  CHECK(agrees("surface by its grains [m]", depth,
               surface_height(bed.grain, bed.spec.length, bed.spec.width, bed.spec.grain_diameter), 1e-12));
}

TEST_CASE("a packing that is no deeper than asked for by half a grain stays as it is") {
  const Packing bed = on_hard_layer(deep(), deep().surface - 0.04);
  CHECK(bed.grain.size() == deep().grain.size());
  CHECK(bed.base.size() == deep().base.size());
  CHECK(bed.surface == deep().surface);
}

TEST_CASE("a bed cut from a deep one stands on its hard layer, and no grain finds a hole in it") {
  const Packing bed = on_hard_layer(deep(), 0.25);
  const sim::PairLaw law{0.5f, 0.1f, 0};
  for (const sim::Backend backend : test::backends()) {
    const auto s = test::simulate(backend, bed_world(bed, {law, law}, 0.3), bed_step_settings(0.1, 2e-3, 60));
    s->advance(150);
    const auto now = s->bodies(0);
    double moved = 0, lowest = 1;
    for (std::size_t i = 0; i < bed.grain.size(); ++i) {
      moved += std::fabs(now[i].position.z - bed.grain[i].position.z) / double(bed.grain.size());
      lowest = std::min(lowest, now[i].position.z);
    }
    CHECK(agrees("mean settlement, in grain diameters", 0, moved / 0.1, 0.01));
    CHECK(lowest > -0.02);
  }
}
