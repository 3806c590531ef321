// Beds of tiles, and the moving patch: ground ahead of a vehicle stays as it was, whatever happens to that behind.
#include "terrain/bed/bed.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::terrain;
using gonogo::test::agrees;

namespace {

const Packing& tile() {
  static const Packing packing = [] {
    BedSpec s;
    s.length = 0.9;
    s.width = 0.72;
    s.depth = 0.36;
    s.grain_diameter = 0.12;
    return settle_packing(s, 1);
  }();
  return packing;
}

/// Gravity on 25 degrees whose fall line is turned by `heading` from x.
Vec3 gravity_on_slope(double heading) {
  const double s = 25 * kDegree, g = kGravity;
  return {Real(-g * std::sin(s) * std::cos(heading)), Real(-g * std::sin(s) * std::sin(heading)),
          Real(-g * std::cos(s))};
}

std::vector<GrainPlace> places(sim::Simulation& s, std::size_t count) {
  return grain_places(s.bodies(0), GrainShape::sphere, count);
}

}  // namespace

TEST_CASE("a bed of tiles has their density and meets itself without a seam") {
  const Packing bed = tiled(tile(), 3, 2);
  CHECK(bed.grain.size() == 6 * tile().grain.size());
  CHECK(bed.base.size() == 6 * tile().base.size());
  CHECK(bed.spec.length == Approx(3 * tile().spec.length));
  // At rest alone is at rest in company: what presses on a tile's sides is its own image.
  const sim::PairLaw law{0.6f, 0.1f, 0};
  for (const sim::Backend backend : test::backends()) {
    const auto s = test::simulate(backend, bed_world(bed, {law, law}, 0.3), bed_step_settings(0.12, 2e-3, 60));
    s->advance(50);
    const auto now = places(*s, bed.grain.size());
    double moved = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
      moved += std::fabs(now[i].position.z - bed.grain[i].position.z) / double(now.size());
    CHECK(agrees("mean settlement, in grain diameters", 0, moved / 0.12, 0.01));
  }
}

TEST_CASE("on 25 degrees along and across the ground ahead is unchanged within 1 % after ten slabs were swapped") {
  const Packing bed = tiled(tile(), 4, 1);
  const sim::PairLaw law{0.8f, 0.2f, 0};
  const MovingPatch patch{bed.spec.length, 1.2};
  for (const double heading : {0.0, 90 * kDegree}) {
    sim::SceneWorld w = bed_world(bed, {law, law}, 1);
    w.gravity = gravity_on_slope(heading);
    const auto s = test::simulate(sim::Backend::cpu, w, bed_step_settings(0.12, 2e-3, 60));
    s->advance(60);
    const std::vector<GrainPlace> start = places(*s, bed.grain.size());
    const double slab = patch.length - 2 * patch.reach;
    double x = 0.5 * patch.length, travelled = 0;
    double worst = 0, ploughed = 0;
    for (int k = 0; travelled < 10 * slab; ++k) {
      // What a vehicle does: it throws the upper grains under it back and aside. (It digs no trench: uphill of one that
      // goes down to the base a slope of 25 degrees comes down for many depths, ahead of any patch.)
      std::vector<sim::BodyIndex> under;
      std::vector<sim::BodyState> thrown;
      const auto bodies = s->bodies(0);
      for (std::size_t i = 0; i < start.size(); ++i)
        if (std::fabs(std::remainder(bodies[i].position.x - x, patch.length)) < 0.3 &&
            bodies[i].position.z > bed.surface - 0.18) {
          under.push_back(sim::BodyIndex(i));
          thrown.push_back(bodies[i]);
          thrown.back().velocity = {Real(-0.5), Real(i % 2 ? 0.5 : -0.5), Real(0.5)};
        }
      s->set_bodies(0, under, thrown);
      s->advance(20);
      x += 0.3;
      travelled += 0.3;
      const auto now = places(*s, start.size());
      double ahead = 0, count = 0;
      for (std::size_t i = 0; i < start.size(); ++i) {
        const double from = std::remainder(start[i].position.x - x, patch.length);
        const double moved = std::hypot(std::remainder(now[i].position.x - start[i].position.x, patch.length),
                                        std::remainder(now[i].position.y - start[i].position.y, bed.spec.width),
                                        now[i].position.z - start[i].position.z);
        if (from > patch.reach) {
          ahead += moved;
          ++count;
        }
        if (std::fabs(from) < 0.9) ploughed = std::max(ploughed, moved);
      }
      worst = std::max(worst, ahead / count);
      renew_ground(*s, 0, patch, start, x);
    }
    CHECK(s->report(0).flags == 0);
    CHECK(ploughed > 0.1 * bed.spec.depth);
    CHECK(agrees("ground ahead moved, in depths of the bed", 0, worst / bed.spec.depth, 0.01));
  }
}

TEST_CASE("a bed too short for its patch is refused") {
  refused([] { check_patch({2.4, 1.2}, 0.09); }, "too short");
  check_patch({3.0, 1.2}, 0.09);
}
