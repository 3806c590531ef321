// Packings that settle side by side.
#include "terrain/bed/bed.h"

#include <algorithm>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::terrain;

namespace {

BedSpec spec_of(double length, double friction, std::uint64_t seed, sim::Backend backend) {
  BedSpec s;
  s.length = length;
  s.width = 0.5;
  s.depth = 0.4;
  s.grain_diameter = 0.1;
  s.settle_friction = friction;
  s.seed = seed;
  s.settled_on = backend;
  return s;
}

bool same_grains(const Packing& a, const Packing& b) {
  bool same = a.grain.size() == b.grain.size() && a.surface == b.surface && a.solid_fraction == b.solid_fraction;
  for (std::size_t i = 0; same && i < a.grain.size(); ++i) {
    const Vec3d &p = a.grain[i].position, &q = b.grain[i].position;
    same = p.x == q.x && p.y == q.y && p.z == q.z && a.grain[i].radius == b.grain[i].radius;
  }
  return same;
}

}  // namespace

TEST_CASE("packings settled in one batch have the bits that they have alone, each at rest on its own clock") {
  for (const sim::Backend backend : test::backends()) {
    // The slippery one keeps moving longest.
    const std::vector<BedSpec> specs{spec_of(0.5, 0.8, 1, backend), spec_of(0.8, 0.02, 2, backend),
                                     spec_of(0.5, 0.25, 3, backend)};
    std::vector<std::size_t> at_rest;
    const std::vector<Packing> together = settle_packings(specs, 2, [&](std::size_t n) { at_rest.push_back(n); });
    CHECK(std::is_sorted(at_rest.begin(), at_rest.end()));
    CHECK(at_rest.back() == specs.size());
    REQUIRE(together.size() == specs.size());
    for (std::size_t k = 0; k < specs.size(); ++k) {
      CHECK(same_grains(together[k], settle_packing(specs[k], 1)));
      CHECK(together[k].residual_speed < 0.01);
      CHECK(together[k].spec.hash() == specs[k].hash());
    }
    CHECK(together[1].solid_fraction > together[0].solid_fraction + 0.02);
  }
}

TEST_CASE("a packing settled on the GPU goes by another name than one settled on the host") {
  CHECK(spec_of(0.5, 0.1, 1, sim::Backend::cpu).hash() != spec_of(0.5, 0.1, 1, sim::Backend::cuda).hash());
}

TEST_CASE("packings of different grains are not settled together") {
  BedSpec other = spec_of(1, 0.1, 2, sim::Backend::cpu);
  other.grain_diameter = 0.09;
  refused([&] { settle_packings({spec_of(0.5, 0.1, 1, sim::Backend::cpu), other}, 1); }, "the same grains");
}
