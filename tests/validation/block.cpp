// A box on a plane: friction, its threshold and its work.
#include <cmath>
#include <string>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

TEST_CASE("a block rests below tan(angle) = mu and slides above it with g (sin - mu cos), whatever its mass") {
  const double seconds = 0.5;
  for (const Backend backend : backends())
    for (const double mu : {0.3, 0.7})
      for (const double mass : {1e-3, 1.0, 1e3})
        for (const double share : {0.5, 0.98, 1.02, 1.5}) {
          const double angle = std::atan(share * mu);
          const auto simulation = simulate(backend, block_on_slope(angle, mu, mass), settings_with(1e-3, 50));
          advance_for(*simulation, seconds);
          const BodyState s = simulation->body(0, 1);
          const double acceleration = -kGravity * (std::sin(angle) - mu * std::cos(angle));
          const double expected = share < 1 ? 0 : acceleration * seconds;
          const std::string label = "mu " + short_text(mu) + ", " + short_text(mass) + " kg, tan / mu " +
                                    short_text(share) + ", " + name_of(backend);
          // The first step drops the block into contact and friction lags by that one step: 1e-3 of the speed reached.
          CHECK(agrees("block on incline, speed [m/s], " + label, expected, s.velocity.x,
                       2e-3 * kGravity * seconds * std::sin(angle)));
          if (share < 1) CHECK(std::abs(s.position.x) < 1e-5);
          CHECK(std::abs(s.orientation.y) < 1e-3);
        }
}

TEST_CASE("a block on a tilted plane slides as on a level one under tilted gravity") {
  const double angle = 0.5, mu = 0.3, seconds = 0.5;
  for (const Backend backend : backends()) {
    SceneWorld w;
    w.origin = {-5, -5, -5};
    w.size = {10, 10, 10};
    w.set_law(0, 0, {Real(mu), 0, 0});
    const Quat tilt = about_y(-angle);  // the plane rises along +x
    add_plane(w, {}, tilt);
    const Vec3d up{-std::sin(angle), 0, std::cos(angle)};
    add_box(w, {up * kBlockHalf, tilt, {}, {}}, {Real(kBlockHalf), Real(kBlockHalf), Real(kBlockHalf)}, 2);
    const auto simulation = simulate(backend, w, settings_with(1e-3, 50));
    advance_for(*simulation, seconds);
    const Vec3d v = static_cast<Vec3d>(simulation->body(0, 1).velocity);
    const double along = dot(v, {std::cos(angle), 0, std::sin(angle)});
    const double expected = -kGravity * (std::sin(angle) - mu * std::cos(angle)) * seconds;
    CHECK(agrees("block on tilted plane, speed [m/s]", expected, along, 3e-3 * std::abs(expected)));
    CHECK(std::abs(dot(v, up)) < 5e-3);
  }
}

TEST_CASE("a block pushed once stops after v^2 / (2 mu g)") {
  const double mu = 0.5, speed = 5;
  for (const Backend backend : backends()) {
    SceneWorld w = block_on_slope(0, mu, 3);
    w.body[1].velocity.x = Real(speed);
    const auto simulation = simulate(backend, w, settings_with(1e-3, 50));
    advance_for(*simulation, 1.5);
    const double expected = speed * speed / (2 * mu * kGravity);  // 2.5484 m
    const BodyState s = simulation->body(0, 1);
    // Half a step of travel, and the gap of h mu v = 2.5 mm that the block falls through while friction waits.
    CHECK(agrees("pushed block, distance v^2 / (2 mu g) [m]", expected, s.position.x, 5e-3 * expected));
    CHECK(std::abs(s.velocity.x) < 1e-4);
  }
}

TEST_CASE("a falling body follows the closed form of the time stepping") {
  SceneWorld w;
  w.origin = {-5, -5, -100};
  w.size = {10, 10, 200};
  const BodyIndex b = w.add_sphere({0, 0, 0}, 0.1f, 1000, 0);
  w.body[b].velocity = {2, 0, 5};
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, w, settings_with(1e-3, 5));
    advance_for(*simulation, 2);
    const BodyState s = simulation->body(0, 0);
    // v first, then x: z = v0 t - g t (t + h) / 2.
    const double t = 2, h = 1e-3, expected = 5 * t - 0.5 * kGravity * t * (t + h);
    // 2000 additions rounded to 5e-7 m/s each, mostly the same way.
    CHECK(agrees("free fall, speed [m/s]", 5 - kGravity * t, s.velocity.z, 2000 * 1e-6 / 2));
    CHECK(agrees("free fall, height [m]", expected, s.position.z, 1e-3));
    CHECK(agrees("free fall, distance [m]", 4, s.position.x, 1e-5));
  }
}

TEST_CASE("a sliding block opens the gap h mu v that the convex relaxation predicts") {
  const double mu = 0.3, speed = 2, step = 0.01;
  for (const Backend backend : backends()) {
    SceneWorld w = block_on_slope(0, mu, 1);
    w.body[1].velocity.x = Real(speed);
    StepSettings settings = settings_with(step, 200);
    settings.envelope = 0.02f;
    const auto simulation = simulate(backend, w, settings);
    simulation->advance(20);
    const BodyState s = simulation->body(0, 1);
    const double gap = s.position.z - kBlockHalf, expected = step * mu * s.velocity.x;
    // contact.md's rule is the steady value; the speed falls by mu g h = 1.5 % a step, and the gap follows within that.
    CHECK(agrees("sliding block, gap h mu v [m]", expected, gap, 0.05 * expected));
  }
}
