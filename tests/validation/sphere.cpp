// One sphere on a plane: sliding, rolling, rolling resistance, impact.
#include <cmath>
#include <string>

#include "base/units.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/validation/sphere_on_slope.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr double kRadius = 0.1;

/// Speed of the sphere's lowest point along x.
double slip(const BodyState& s) { return s.velocity.x - s.angular_velocity.y * kRadius; }

}  // namespace

TEST_CASE("a sliding sphere ends rolling at 5/7 of its speed after 2 v0 / (7 mu g)") {
  const double speed = 2;
  for (const Backend backend : backends())
    for (const double mu : {0.1, 0.5}) {
      SceneWorld w = sphere_on_slope(0, mu, 0);
      w.body[1].velocity.x = Real(speed);
      const double step = 1e-3, expected_time = 2 * speed / (7 * mu * kGravity);
      const auto simulation = simulate(backend, w, settings_with(step, 60));
      double rolling_since = 0;
      for (int i = 0; i < 1.5 * expected_time / step; ++i) {
        simulation->advance(1);
        if (slip(simulation->body(0, 1)) > 1e-3 * speed) rolling_since = simulation->report(0).time + step;
      }
      const BodyState s = simulation->body(0, 1);
      const std::string label = std::string(name_of(backend)) + ", mu " + short_text(mu);
      // The hop of the first step (next case) shifts the time a little and the end not at all: rolling is 5/7 v0. What
      // is left is the gap's closing, of the order of h mu g, and a step in the time.
      CHECK(agrees("slide to roll, final speed [m/s], " + label, speed * 5 / 7, s.velocity.x, 1e-3 * speed));
      CHECK(agrees("slide to roll, spin times radius [m/s], " + label, speed * 5 / 7, s.angular_velocity.y * kRadius,
                   1e-3 * speed));
      CHECK(agrees("slide to roll, time of rolling [s], " + label, expected_time, rolling_since,
                   0.02 * expected_time + step));
    }
}

TEST_CASE("the convex relaxation lifts a sliding sphere to the gap h mu v and speeds its first step up") {
  // A sphere that slides with its gap at zero: the relaxation asks for u_n = mu s after the step (s: slip speed), so
  // p_n / m = g h + mu s and s = v0 - 7/2 mu p_n / m. Coulomb's law would give p_n / m = g h.
  const double speed = 2, mu = 0.1, step = 0.01;
  const double slip_after = (speed - 3.5 * mu * kGravity * step) / (1 + 3.5 * mu * mu);
  const double push = kGravity * step + mu * slip_after;
  for (const Backend backend : backends()) {
    SceneWorld w = sphere_on_slope(0, mu, 0);
    w.body[1].velocity.x = Real(speed);
    StepSettings settings = settings_with(step, 300);
    settings.envelope = 0.02f;
    const auto simulation = simulate(backend, w, settings);
    simulation->advance(1);
    const BodyState first = simulation->body(0, 1);
    // Arms in single precision: the starting gap is zero to 1e-8 m, so biases are to 1e-6 m/s.
    CHECK(agrees("relaxation, first step: speed [m/s]", speed - mu * push, first.velocity.x, 1e-5));
    CHECK(agrees("relaxation, first step: lift [m/s]", mu * slip_after, first.velocity.z, 1e-5));
    CHECK(agrees("relaxation, first step: gap h mu s [m]", step * mu * slip_after, first.position.z - kRadius, 1e-7));
    // The lift is a hop; landed, the sphere slides at the gap h mu s, which shrinks with the slip at 7/2 mu g.
    simulation->advance(20);
    const BodyState later = simulation->body(0, 1);
    CHECK(agrees("relaxation, after 20 more steps: gap h mu s [m]", step * mu * slip(later), later.position.z - kRadius,
                 0.03 * step * mu * slip(later)));
    const double sinking = -3.5 * mu * mu * kGravity * step;
    CHECK(agrees("relaxation, after 20 more steps: v_z [m/s]", sinking, later.velocity.z, 0.1 * std::abs(sinking)));
    // Whatever the hop, the normal impulse is what gravity gave and the sphere kept: friction took mu times that.
    CHECK(agrees("relaxation, after 20 more steps: speed [m/s]", speed - mu * (kGravity * 21 * step + sinking),
                 later.velocity.x, 1e-4));
  }
}

TEST_CASE("a sphere on an incline rolls with 5/7 g sin where friction suffices and slips where it does not") {
  const double seconds = 0.5;
  for (const Backend backend : backends())
    for (const double angle : {0.05, 0.3, 0.9}) {
      const double mu = 0.3;  // rolls up to tan(angle) = 7/2 mu
      const auto simulation = simulate(backend, sphere_on_slope(angle, mu, 0), settings_with(1e-3, 60));
      advance_for(*simulation, seconds);
      const BodyState s = simulation->body(0, 1);
      const bool rolls = std::tan(angle) < 3.5 * mu;
      const double speed =
          (rolls ? 5.0 / 7 * std::sin(angle) : std::sin(angle) - mu * std::cos(angle)) * kGravity * seconds;
      const double spin = rolls ? speed : 2.5 * mu * kGravity * std::cos(angle) * seconds;
      const std::string label = short_text(to_degrees(angle)) + " degrees, " + name_of(backend);
      // The first step finds the gap at zero and hops; the speed it takes is a step's worth, 1/500.
      CHECK(agrees("incline, speed [m/s], " + label, -speed, s.velocity.x, 2e-3 * speed));
      CHECK(agrees("incline, spin times radius [m/s], " + label, -spin, s.angular_velocity.y * kRadius, 2e-3 * spin));
    }
}

TEST_CASE("rolling resistance holds a sphere below atan(mu_r) and lets it roll above") {
  const double rolling = 0.15, seconds = 0.5;
  for (const Backend backend : backends())
    for (const double share : {0.5, 0.98, 1.05, 2.0}) {
      const double angle = std::atan(share * rolling);
      const auto simulation = simulate(backend, sphere_on_slope(angle, 0.8, rolling), settings_with(1e-3, 60));
      advance_for(*simulation, seconds);
      const double expected =
          share < 1 ? 0 : -5.0 / 7 * kGravity * (std::sin(angle) - rolling * std::cos(angle)) * seconds;
      const std::string label = "tan / mu_r = " + short_text(share) + ", " + name_of(backend);
      // The first step again: 1/500 of what gravity alone would give.
      CHECK(agrees("rolling resistance on an incline, speed [m/s], " + label, expected,
                   simulation->body(0, 1).velocity.x, 2e-3 * kGravity * seconds * std::sin(angle)));
    }
}

TEST_CASE("rolling resistance slows a rolling sphere by 5/7 mu_r g") {
  const double rolling = 0.05, speed = 1, seconds = 1;
  for (const Backend backend : backends()) {
    SceneWorld w = sphere_on_slope(0, 0.8, rolling);
    w.body[1].velocity.x = Real(speed);
    w.body[1].angular_velocity.y = Real(speed / kRadius);
    const auto simulation = simulate(backend, w, settings_with(1e-3, 60));
    advance_for(*simulation, seconds);
    // A step's worth, as above.
    CHECK(agrees(std::string("rolling decay, speed [m/s], ") + name_of(backend),
                 speed - 5.0 / 7 * rolling * kGravity * seconds, simulation->body(0, 1).velocity.x, 1e-3 * speed));
  }
}

TEST_CASE("an oblique impact without rebound slips or sticks by the closed form") {
  const double mu = 0.2, down = 1, step = 1e-3;
  for (const Backend backend : backends())
    for (const double along : {0.3, 0.6, 1.5, 4.0}) {
      const bool slips = along >= 3.5 * mu * down;
      const double slip_after = slips ? along - 3.5 * mu * down : 0;
      // Coulomb's impact where the sphere starts with the gap that its slip afterwards holds open; see the next case.
      SceneWorld w = sphere_on_slope(0, mu, 0);
      w.gravity = {};
      w.body[1].position.z += step * mu * slip_after;
      w.body[1].velocity = {Real(along), 0, Real(-down)};
      const auto simulation = simulate(backend, w, settings_with(step, 200));
      simulation->advance(1);
      const BodyState s = simulation->body(0, 1);
      const std::string label = "v_x / v_z = " + short_text(along / down) + ", " + name_of(backend);
      // Single-precision arms resolve the gap to 1e-8 m, its speed to 1e-5 m/s; the contact point lies half-way across
      // the gap, which lengthens the sphere's arm by that much.
      const double tolerance = 3e-5 + down * step * mu * slip_after / (2 * kRadius);
      CHECK(agrees("oblique impact, speed along [m/s], " + label, slips ? along - mu * down : along * 5 / 7,
                   s.velocity.x, tolerance));
      CHECK(agrees("oblique impact, spin times radius [m/s], " + label, slips ? 2.5 * mu * down : along * 5 / 7,
                   s.angular_velocity.y * kRadius, tolerance));
      CHECK(agrees("oblique impact, rebound [m/s], " + label, 0, s.velocity.z, tolerance));
    }
}

TEST_CASE("an oblique impact that slips with the gap closed rebounds by the relaxation's mu s") {
  const double mu = 0.2, down = 1, along = 4, step = 1e-3;
  const double slip_after = (along - 3.5 * mu * down) / (1 + 3.5 * mu * mu);
  for (const Backend backend : backends()) {
    SceneWorld w = sphere_on_slope(0, mu, 0);
    w.gravity = {};
    w.body[1].velocity = {Real(along), 0, Real(-down)};
    const auto simulation = simulate(backend, w, settings_with(step, 200));
    simulation->advance(1);
    const BodyState s = simulation->body(0, 1);
    CHECK(agrees("relaxed impact, rebound [m/s]", mu * slip_after, s.velocity.z, 3e-5));
    CHECK(agrees("relaxed impact, speed along [m/s]", along - mu * (down + mu * slip_after), s.velocity.x, 3e-5));
  }
}
