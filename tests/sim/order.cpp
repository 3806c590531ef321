// Bodies that have mixed are sorted anew in memory; nothing but speed and rounding may tell.
#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr int kBalls = 400;
constexpr Index kSortEvery = 40;

/// Balls of many sizes that fly about in a periodic box, with a driven pair of joined rods among them.
SceneWorld gas(std::uint64_t seed) {
  Draw draw(seed);
  SceneWorld w;
  w.gravity = {};
  w.size = {0.8, 0.8, 1.2};
  w.periodic_x = w.periodic_y = true;
  w.overlap_limit = 0;
  w.set_law(0, 0, {0.3f, 0.05f, 0});
  add_plane(w);
  add_plane(w, {0, 0, 1.1}, about_x(kPi));
  for (int k = 0; k < kBalls; ++k) {
    const Vec3d cell = grid_place(k, 8, 8) + Vec3d{0.5, 0.5, 1};
    const BodyIndex b = w.add_sphere(cell * 0.1, Real(draw.between(0.02, 0.04)), 2000, 0);
    w.body[b].velocity = static_cast<Vec3>(draw.direction() * 4.0);
  }
  const BodyIndex rod = add_box(w, {{0.4, 0.4, 0.9}, {}, {}, {}}, {0.1f, 0.01f, 0.01f}, 1);
  const BodyIndex other = add_box(w, {{0.6, 0.4, 0.9}, {}, {}, {}}, {0.1f, 0.01f, 0.01f}, 1);
  w.joint.push_back(revolute(w, other, rod, {0.5, 0.4, 0.9}, {0, 0, 1}));
  w.motor.push_back(speed_motor(w.joint.back(), 5, 2));
  return w;
}

StepSettings sorting(Index every) {
  StepSettings s;
  s.iterations = 10;
  s.sort_every = every;
  return s;
}

double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

}  // namespace

TEST_CASE("bodies that have mixed are sorted anew, and every answer stays with its body") {
  for (const Backend backend : backends()) {
    const SceneWorld w = gas(1);
    const auto simulation = make_simulation(backend, {w}, sorting(kSortEvery), 1);
    const auto first = simulation->snapshot(0).place_of_body;
    simulation->advance(kSortEvery);
    CHECK(simulation->snapshot(0).place_of_body == first);  // due at the next step
    const auto before = simulation->bodies(0);
    const double spin = before[kBalls + 2].angular_velocity.z;
    simulation->advance(1);
    CHECK(simulation->snapshot(0).place_of_body != first);
    const auto after = simulation->bodies(0);
    for (std::size_t b = 0; b < after.size(); ++b) {
      Vec3d way = after[b].position - before[b].position;
      way.x -= 0.8 * std::round(way.x / 0.8);
      way.y -= 0.8 * std::round(way.y / 0.8);
      CHECK(length(way) < 0.02);  // 4 m/s, at most doubled by impacts, in 1e-3 s
    }
    const BodiesOnDevice there = simulation->bodies_on_device(0, 1);
    CHECK((there.gpu >= 0) == (backend == Backend::cuda));
    if (backend == Backend::cpu)
      CHECK(same_bits(std::vector<BodyState>(there.state.get(), there.state.get() + there.count), after));
    CHECK(simulation->report(0).flags == 0);
    CHECK(std::abs(after[kBalls + 2].angular_velocity.z - spin) < 1);
    double least = 1;
    for (const Contact& c : simulation->contacts(0)) {
      const bool balls = c.body_a >= 2 && c.body_b >= 2 && c.body_a < kBalls + 2 && c.body_b < kBalls + 2;
      if (!balls) continue;
      const double apart = length(static_cast<Vec3d>(c.arm_a - c.arm_b));
      const double radii = double(w.shape[c.body_a].size.x) + double(w.shape[c.body_b].size.x);
      least = std::min(least, 1 - std::abs(apart - radii) / radii);
    }
    CHECK(least > 0.9);  // arms are the radii of the bodies that the contact names
  }
}

TEST_CASE("the joint and the motor of sorted bodies go on") {
  for (const Backend backend : backends()) {
    const auto simulation = make_simulation(backend, {gas(2)}, sorting(kSortEvery), 1);
    for (int k = 0; k < 5; ++k) {
      simulation->advance(kSortEvery);
      const BodyState a = simulation->body(0, kBalls + 2), b = simulation->body(0, kBalls + 3);
      const Vec3 end = rotate(a.orientation, {0.1f, 0, 0}), start = rotate(b.orientation, {-0.1f, 0, 0});
      Vec3d gap = a.position + static_cast<Vec3d>(end) - b.position - static_cast<Vec3d>(start);
      gap.x -= 0.8 * std::round(gap.x / 0.8);
      gap.y -= 0.8 * std::round(gap.y / 0.8);
      CHECK(length(gap) < 1e-3);
    }
    CHECK(std::abs(simulation->motor_torque(0, 0)) <= 2.001);
  }
}

TEST_CASE("sorted worlds have the same bits alone, in company, with any number of threads and after a restore") {
  constexpr Index kSteps = 3 * kSortEvery + 10, kBreak = kSortEvery + 25;
  for (const Backend backend : backends()) {
    const auto alone = make_simulation(backend, {gas(3)}, sorting(kSortEvery), 1);
    alone->advance(kSteps);
    const auto expected = alone->bodies(0);

    const auto company = make_simulation(backend, {gas(4), gas(3), gas(5)}, sorting(kSortEvery), 7);
    company->advance(17);
    company->replace(0, gas(6));  // sorted at other times than its neighbours
    company->advance(kSteps - 17);
    CHECK(same_bits(company->bodies(1), expected));

    const auto broken = make_simulation(backend, {gas(3)}, sorting(kSortEvery), 2);
    broken->advance(kBreak);
    const auto restored = make_simulation(backend, {gas(4), gas(3)}, sorting(kSortEvery), 2);
    restored->advance(9);
    restored->restore(1, broken->snapshot(0));
    restored->advance(kSteps - kBreak);
    CHECK(same_bits(restored->bodies(1), expected));
  }
}
