// What the solver owes to Coulomb's law: a block that sticks whatever its mass, and says so; sliding and slipping
// impacts without the lift of the convex relaxation.
#include <cmath>
#include <string>
#include <vector>

#include "base/units.h"
#include "sim/law/contact_law.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {}  // namespace

TEST_CASE("a block of 1 g to 1 t sticks on a slope of 20 degrees with mu 0.5, and the residual says so alike") {
  const double angle = to_radians(20);
  for (const Backend backend : backends())
    for (const Target target : {Target::ccp, Target::coulomb}) {
      std::vector<double> starved;
      for (const double mass : {1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3}) {
        const SceneWorld scene = block_on_slope(angle, 0.5, mass);
        const auto simulation = simulate(backend, scene, settings_with(1e-3, 100, target));
        simulation->advance(1000);
        const BodyState s = simulation->body(0, 1);
        const std::string label = short_text(mass) + " kg, " + name_of(target) + ", " + gonogo::test::name_of(backend);
        CHECK(agrees("block at 20 degrees, distance after 1 s [m], " + label, 0, s.position.x, 1e-6));
        CHECK(agrees("block at 20 degrees, speed [m/s], " + label, 0, s.velocity.x, 1e-6));
        // In m/s whatever the mass: a block without friction would miss by g h sin = 3.4e-3 m/s.
        CHECK(agrees("block at 20 degrees, residual [m/s], " + label, 0, simulation->report(0).max_residual, 1e-6));
        const auto hasty = simulate(backend, scene, settings_with(1e-3, 1, target));
        hasty->advance(1);
        starved.push_back(hasty->report(0).max_residual);
      }
      // One iteration from nothing does not solve it: the residual must say that too, and the same for every mass.
      for (const double residual : starved) {
        CHECK(residual > 1e-4);
        CHECK(residual == Approx(starved[0]).epsilon(1e-3));
      }
    }
}

TEST_CASE("under Coulomb's law a sliding block keeps to the plane and loses mu g h a step; the relaxation lifts it") {
  const double mu = 0.3, speed = 2, step = 0.01;
  for (const Backend backend : backends()) {
    double gap[2];
    for (const Target target : {Target::ccp, Target::coulomb}) {
      SceneWorld w = block_on_slope(0, mu, 1);
      w.body[1].velocity.x = Real(speed);
      StepSettings settings = settings_with(step, 200, target);
      settings.envelope = 0.02f;
      const auto simulation = simulate(backend, w, settings);
      simulation->advance(12);
      const BodyState s = simulation->body(0, 1);
      gap[int(target)] = s.position.z - kBlockHalf;
      const double expected = speed - 12 * mu * kGravity * step;
      if (target == Target::coulomb) {
        CHECK(agrees("sliding block, Coulomb: speed after 12 steps [m/s]", expected, s.velocity.x, 1e-4));
        CHECK(agrees("sliding block, Coulomb: gap [m]", 0, gap[1], 1e-6));
        CHECK(std::abs(s.orientation.y) < 1e-5);
      }
    }
    CHECK(agrees("sliding block, relaxation: gap h mu v [m]", step * mu * 1.65, gap[0], 0.1 * step * mu * 1.65));
  }
}

TEST_CASE("under Coulomb's law an impact that slips does not rebound, and takes mu times its normal speed") {
  const double radius = 0.1, mu = 0.2, down = 1, step = 1e-3;
  for (const Backend backend : backends())
    for (const double along : {0.3, 2.0, 6.0}) {
      SceneWorld w;
      w.origin = {-5, -5, -1};
      w.size = {10, 10, 3};
      w.gravity = {};
      w.set_law(0, 0, {Real(mu), 0, 0});
      add_plane(w);
      w.add_sphere({0, 0, radius}, Real(radius), density_for(1, radius), 0);
      w.body[1].velocity = {Real(along), 0, Real(-down)};
      const auto simulation = simulate(backend, w, settings_with(step, 300, Target::coulomb));
      simulation->advance(1);
      const BodyState s = simulation->body(0, 1);
      // It sticks when friction can stop the contact point: 2/7 m v_x <= mu m v_z.
      const bool sticks = along <= 3.5 * mu * down;
      const std::string label = ", v_x / v_z " + short_text(along / down) + ", " + gonogo::test::name_of(backend);
      CHECK(agrees("oblique impact, Coulomb: rebound [m/s]" + label, 0, s.velocity.z, 1e-4 * along));
      CHECK(agrees("oblique impact, Coulomb: speed along [m/s]" + label, sticks ? along * 5 / 7 : along - mu * down,
                   s.velocity.x, 1e-4 * along));
      CHECK(agrees("oblique impact, Coulomb: spin times radius [m/s]" + label, sticks ? along * 5 / 7 : 2.5 * mu * down,
                   s.angular_velocity.y * radius, 1e-4 * along));
    }
}

TEST_CASE("under Coulomb's law rolling and spinning balls keep to the plane; the relaxation lifts them") {
  const double radius = 0.1, rolling = 0.2, spinning = 0.1, speed = 2, spin = 30, step = 0.002;
  const Index steps = 40;
  for (const Backend backend : backends())
    for (const Target target : {Target::ccp, Target::coulomb}) {
      SceneWorld w;
      w.origin = {-5, -5, -1};
      w.size = {10, 10, 3};
      PairLaw law{Real(0.6), Real(rolling), 0};
      law.spinning_friction = Real(spinning);
      w.set_law(0, 0, law);
      add_plane(w);
      w.add_sphere({0, -1, radius}, Real(radius), density_for(1, radius), 0);
      w.body[1].velocity.x = Real(speed);
      w.body[1].angular_velocity.y = Real(speed / radius);
      w.add_sphere({0, 1, radius}, Real(radius), density_for(1, radius), 0);
      w.body[2].angular_velocity.z = Real(spin);
      StepSettings settings = settings_with(step, 200, target);
      settings.envelope = 0.02f;
      const auto simulation = simulate(backend, w, settings);
      simulation->advance(steps);
      const BodyState rolls = simulation->body(0, 1), spins = simulation->body(0, 2);
      if (target == Target::ccp) {
        // Gaps of a step at the speed that the cone's sides demand: c_r r w and c_s r w.
        CHECK(rolls.position.z - radius > 0.5 * step * rolling * rolls.velocity.x);
        CHECK(spins.position.z - radius > 0.5 * step * spinning * radius * spins.angular_velocity.z);
        continue;
      }
      const double time = steps * step;
      const std::string label = std::string(", ") + gonogo::test::name_of(backend);
      CHECK(agrees("rolling ball, Coulomb: gap [m]" + label, 0, rolls.position.z - radius, 2e-6));
      CHECK(agrees("rolling ball, Coulomb: speed, v - 5/7 c_r g t [m/s]" + label,
                   speed - 5.0 / 7 * rolling * kGravity * time, rolls.velocity.x, 2e-4));
      CHECK(agrees("spinning ball, Coulomb: gap [m]" + label, 0, spins.position.z - radius, 2e-6));
      CHECK(agrees("spinning ball, Coulomb: spin, w - 5/2 c_s g t / r [rad/s]" + label,
                   spin - 2.5 * spinning * kGravity * time / radius, spins.angular_velocity.z, 2e-3));
    }
}
