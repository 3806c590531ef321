// Several bodies: stacks, heavy on light, cohesion, a driven wheel.
#include <algorithm>
#include <cmath>
#include <string>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

TEST_CASE("a stack of five spheres at rest stays, and the floor carries its weight") {
  const double radius = 0.1, mass = 2;
  for (const Backend backend : backends()) {
    SceneWorld w;
    w.origin = {-1, -1, -1};
    w.size = {2, 2, 3};
    w.set_law(0, 0, {Real(0.5), 0, 0});
    const BodyIndex floor = add_plane(w);
    for (int i = 0; i < 5; ++i) w.add_sphere({0, 0, radius * (2 * i + 1)}, Real(radius), density_for(mass, radius), 0);
    const auto simulation = simulate(backend, w, settings_with(1e-3, 60));
    advance_for(*simulation, 1);
    double sideways = 0, sunk = 0;
    const auto bodies = simulation->bodies(0);
    for (int i = 0; i < 5; ++i) {
      const Vec3d& p = bodies[i + 1].position;
      sideways = std::max({sideways, std::abs(p.x), std::abs(p.y)});
      sunk = std::max(sunk, std::abs(p.z - radius * (2 * i + 1)));
    }
    CHECK(agrees("stack, largest sideways move [m]", 0, sideways, 1e-6));
    // Overlap is pushed out slowly: a standing error of the solver shows as a standing overlap below a thousandth
    // radius.
    CHECK(agrees("stack, largest change of height [m]", 0, sunk, 1e-3 * radius));
    CHECK(agrees("stack, force on the floor [N]", -5 * mass * kGravity, simulation->contact_force(0, floor).z,
                 1e-3 * 5 * mass * kGravity));
  }
}

TEST_CASE("a bed of light grains carries a block a thousand times heavier than each of them") {
  const double radius = 0.01, grain = 2600 * 4.0 / 3 * kPi * radius * radius * radius;
  const double mass = 1000 * grain;
  for (const Backend backend : backends()) {
    Draw draw(801);
    SceneWorld w;
    w.origin = {-0.1, -0.1, -0.05};
    w.size = {0.2, 0.2, 0.4};
    w.periodic_x = w.periodic_y = true;
    w.set_law(0, 0, {Real(0.6), Real(0.1), 0});
    add_plane(w);
    for (int x = 0; x < 9; ++x)
      for (int y = 0; y < 9; ++y)
        for (int z = 0; z < 3; ++z)
          w.add_sphere({-0.1 + 0.0222 * (x + 0.5), -0.1 + 0.0222 * (y + 0.5), radius * (2.02 * z + 1.01)},
                       Real(radius * draw.between(0.95, 1)), 2600, 0);
    // As wide as the bed, so that the grains cannot flow out from under it.
    const BodyIndex block = add_box(w, {{0, 0, 0.065 + 0.05}, {}, {}, {}}, {0.0995f, 0.0995f, 0.05f}, mass);
    const auto simulation = simulate(backend, w, settings_with(5e-4, 50));
    advance_for(*simulation, 1);
    double force = 0, worst = 0;
    // Half a second: what is left of the block's bouncing (a centimetre per second) then weighs 0.2 % of its weight.
    const int samples = 1000;
    for (int i = 0; i < samples; ++i) {
      simulation->advance(1);
      const double now = simulation->contact_force(0, block).z;
      force += now / samples;
      worst = std::max(worst, std::abs(now / (mass * kGravity) - 1));
    }
    const BodyState s = simulation->body(0, block);
    INFO("block at " << s.position.z << " m, speed " << s.velocity.z << " m/s, contacts "
                     << simulation->report(0).contact_count << ", residual " << simulation->report(0).max_residual);
    CHECK(agrees("block on grains, mean force [N]", mass * kGravity, force, 0.01 * mass * kGravity));
    std::printf("  largest deviation in a step %.2g of the weight, residual %.2g m/s\n", worst,
                simulation->report(0).max_residual);
    CHECK(std::abs(s.velocity.z) < 0.01f);
    CHECK(simulation->report(0).flags == 0);
  }
}

TEST_CASE("cohesion holds a hanging grain below pi r^2 p_c and lets go above") {
  const double radius = 0.02, pressure = 2000, strength = kPi * radius * radius * pressure;
  for (const Backend backend : backends())
    for (const double share : {0.5, 0.98, 1.02, 2.0}) {
      SceneWorld w;
      w.origin = {-1, -1, -20};
      w.size = {2, 2, 22};
      w.set_law(0, 0, {Real(0.5), 0, Real(pressure)});
      w.add_sphere({0, 0, 0}, Real(0.03), 1000, 0);  // the smaller sphere's section counts
      w.mass[0] = fixed_body();
      w.add_sphere({0, 0, -0.05}, Real(radius), density_for(share * strength / kGravity, radius), 0);
      const auto simulation = simulate(backend, w, settings_with(1e-3, 30));
      advance_for(*simulation, 0.5);
      const double fallen = -0.05 - simulation->body(0, 1).position.z;
      INFO(name_of(backend) << " weight / strength " << share);
      if (share < 1) {
        CHECK(agrees("cohesion, held, fallen [m]", 0, fallen, 1e-5));
        CHECK(agrees("cohesion, pull on the upper grain [N]", -share * strength, simulation->contact_force(0, 0).z,
                     1e-3 * strength));
      } else {
        // It lets go at once: the force acts only within cohesion_range, 0.5 mm, which takes sqrt(2 x / (a)) at the
        // surplus a = g (1 - 1 / share); free fall after that.
        const double surplus = kGravity * (1 - 1 / share), range = simulation->settings().cohesion_range;
        const double held = std::sqrt(2 * range / surplus), rest = 0.5 - held;
        const double expected = range + surplus * held * rest + 0.5 * kGravity * rest * rest;
        CHECK(agrees("cohesion, let go, fallen [m]", expected, fallen, 0.03 * expected));
      }
    }
}

TEST_CASE("a motor spins a free wheel up at T / I to its speed and holds it") {
  const double torque = 3, inertia = 0.5, speed = 4;
  for (const Backend backend : backends()) {
    SceneWorld w;
    w.origin = {-1, -1, -1};
    w.size = {2, 2, 2};
    w.gravity = {};
    const BodyIndex b = w.add_body({}, solid(5, {1, Real(inertia), 1}));
    w.motor.push_back(speed_motor(w, b, kWorld, {0, 1, 0}, speed, torque));
    const auto simulation = simulate(backend, w, settings_with(1e-3, 40));
    advance_for(*simulation, 0.5);
    CHECK(agrees("motor at its limit, speed [rad/s]", torque / inertia * 0.5, simulation->body(0, b).angular_velocity.y,
                 1e-4));
    CHECK(agrees("motor at its limit, torque [N m]", torque, simulation->motor_torque(0, 0), 1e-6 * torque));
    CHECK(agrees("motor at its limit, power [W]", torque * torque / inertia * 0.5, simulation->report(0).motor_power,
                 1e-3));
    advance_for(*simulation, 0.5);
    CHECK(agrees("motor at its speed, speed [rad/s]", speed, simulation->body(0, b).angular_velocity.y, 1e-5));
    CHECK(agrees("motor at its speed, torque [N m]", 0, simulation->motor_torque(0, 0), 1e-3));
  }
}

TEST_CASE("a lugged wheel drives over fixed grains within its torque and reaches its speed") {
  const double speed = 3, limit = 40, weight = 300;
  for (const Backend backend : backends()) {
    Draw draw(802);
    SceneWorld w;
    w.origin = {0, 0, -0.5};
    w.size = {2, 0.4, 2};
    w.periodic_x = w.periodic_y = true;
    w.set_law(0, 1, {Real(0.8), 0, 0});
    for (int x = 0; x < 40; ++x)
      for (int y = 0; y < 8; ++y) {
        const BodyIndex g = w.add_sphere({0.05 * x, 0.05 * y, draw.between(0, 0.005)}, 0.024f, 2600, 0);
        w.mass[g] = fixed_body();
      }
    Shape s;
    s.type = ShapeType::wheel;
    s.material = 1;
    s.size = {0.25f, 0.1f, 0.03f};
    s.lug_count = 16;
    s.lug_thickness = 0.02f;
    BodyMass m = solid(Real(weight / kGravity), {1, 0.8f, 1});
    m.inverse_mass.y = m.inverse_inertia_B.x = m.inverse_inertia_B.z = 0;
    s.body = w.add_body({{1, 0.2, 0.31}, {}, {}, {}}, m);
    w.add_shape(s);
    w.motor.push_back(speed_motor(w, s.body, kWorld, {0, 1, 0}, speed, limit));
    const auto simulation = simulate(backend, w, settings_with(1e-3, 40));
    double max_torque = 0, mean_speed = 0, load = 0, travelled = 0;
    const int steps = 3000, last = 1500;
    for (int i = 0; i < steps; ++i) {
      simulation->advance(1);
      max_torque = std::max(max_torque, std::abs(simulation->motor_torque(0, 0)));
      if (i < steps - last) continue;
      const BodyState now = simulation->body(0, s.body);
      mean_speed += now.angular_velocity.y / last;
      travelled += now.velocity.x * 1e-3;
      load += simulation->contact_force(0, s.body).z / last;
    }
    CHECK(agrees("wheel, largest torque over its limit [-]", 1, max_torque / limit, 1e-5));
    CHECK(agrees("wheel, mean speed [rad/s]", speed, mean_speed, 0.02 * speed));
    CHECK(agrees("wheel, mean load [N]", weight, load, 0.03 * weight));
    // Rolling radius between the rim and the lugs' tips.
    CHECK(agrees("wheel, rolling radius [m]", 0.265, travelled / (mean_speed * last * 1e-3), 0.015));
    CHECK(simulation->report(0).flags == 0);
  }
}
