#include <algorithm>
#include <cmath>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

struct Momenta {
  Vec3d linear, angular;
  double linear_size = 0, angular_size = 0;  // sums of magnitudes, for the scale of rounding
  double kinetic = 0;
};

double inverse(Real x) { return x > 0 ? 1.0 / x : 0; }

/// Of bodies with three equal moments of inertia.
Momenta momenta(const SceneWorld& w, const std::vector<BodyState>& bodies) {
  Momenta m;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double mass = inverse(w.mass[b].inverse_mass.x), inertia = inverse(w.mass[b].inverse_inertia_B.x);
    const Vec3d v = static_cast<Vec3d>(bodies[b].velocity), spin = static_cast<Vec3d>(bodies[b].angular_velocity);
    const Vec3d p = v * mass, l = cross(bodies[b].position, p) + spin * inertia;
    m.linear += p;
    m.angular += l;
    m.linear_size += length(p);
    m.angular_size += length(bodies[b].position) * length(p) + length(spin) * inertia;
    m.kinetic += 0.5 * (mass * dot(v, v) + inertia * dot(spin, spin));
  }
  return m;
}

/// Spheres of two materials flying towards the origin without gravity, 1 g to 1 kg.
SceneWorld implosion(std::uint64_t seed) {
  Draw draw(seed);
  SceneWorld w;
  w.gravity = {};
  w.origin = {-1, -1, -1};
  w.size = {2, 2, 2};
  w.set_law(0, 0, {Real(0.5), Real(0.1), 0});
  w.set_law(0, 1, {Real(0.9), 0, 0});
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 5; ++z) {
        const Vec3d at = Vec3d{x - 2.0, y - 2.0, z - 2.0} * 0.1 + draw.direction() * 0.01;
        const double radius = draw.between(0.02, 0.035);
        const BodyIndex b = w.add_sphere(at, Real(radius), density_for(draw.magnitude(1e-3, 1), radius), draw.below(2));
        w.body[b].velocity = static_cast<Vec3>(at * -2.0 + draw.direction() * 0.2);
        w.body[b].angular_velocity = static_cast<Vec3>(draw.direction() * 10.0);
      }
  return w;
}

}  // namespace

TEST_CASE("free spheres that collide keep their momentum and gain no energy") {
  const SceneWorld w = implosion(401);
  StepSettings settings;
  settings.iterations = 40;
  settings.recovery_speed = 0;  // pushing overlaps apart would do work
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, w, settings);
    const Momenta before = momenta(w, simulation->bodies(0));
    double last = before.kinetic, largest_gain = 0;
    Index max_contacts = 0;
    const int steps = 300;
    for (int i = 0; i < steps; ++i) {
      simulation->advance(1);
      const double kinetic = momenta(w, simulation->bodies(0)).kinetic;
      REQUIRE(simulation->report(0).kinetic_energy == Approx(kinetic).epsilon(1e-6));
      largest_gain = std::max(largest_gain, kinetic - last);
      max_contacts = std::max(max_contacts, simulation->report(0).contact_count);
      last = kinetic;
    }
    const Momenta after = momenta(w, simulation->bodies(0));
    const double drift = length(after.linear - before.linear) / before.linear_size;
    const double turn_drift = length(after.angular - before.angular) / before.angular_size;
    INFO(name_of(backend) << ": momentum drift " << drift << ", angular " << turn_drift << ", kinetic energy "
                          << before.kinetic << " J to " << after.kinetic << " J, largest gain in a step "
                          << largest_gain << " J, most contacts " << max_contacts);
    // Every step rounds each velocity once (6e-8); 300 of them add up at worst.
    CHECK(drift < steps * 6e-8);
    CHECK(turn_drift < steps * 6e-8);
    // The exact solution never gains; an unfinished iteration may by its residual's share.
    CHECK(largest_gain < 1e-4 * before.kinetic);
    CHECK(after.kinetic < 0.5 * before.kinetic);
    CHECK(max_contacts > 100);
    WARN(name_of(backend) << ": momentum drift " << drift << ", angular " << turn_drift << ", largest gain "
                          << largest_gain / before.kinetic << " of the kinetic energy");
  }
}

TEST_CASE("a box and spheres sliding freely on a plane only lose energy") {
  SceneWorld w;
  w.origin = {-5, -5, -1};
  w.size = {10, 10, 2};
  w.set_law(0, 0, {Real(0.4), Real(0.02), 0});
  add_plane(w);
  add_box(w, {{0, 0, 0.1}, {}, {Real(1.5), Real(0.5), 0}, {0, 0, 3}}, {0.2f, 0.15f, 0.1f}, 5);
  for (int i = 0; i < 5; ++i) {
    const BodyIndex b = w.add_sphere({0.1 * i - 0.2, 0.5, 0.04}, Real(0.04), 2600, 0);
    w.body[b].velocity = {Real(1 + 0.1 * i), Real(0.2), 0};
    w.body[b].angular_velocity = {0, Real(-20 + 10 * i), Real(5)};
  }
  StepSettings settings;
  settings.iterations = 100;
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, w, settings);
    simulation->advance(1);
    const double start = simulation->report(0).kinetic_energy;
    double energy = start, largest_gain = 0;
    const auto potential = [&] {
      double sum = 0;
      const auto bodies = simulation->bodies(0);
      for (std::size_t b = 0; b < bodies.size(); ++b)
        sum += inverse(w.mass[b].inverse_mass.z) * kGravity * bodies[b].position.z;
      return sum;
    };
    double level = potential();
    for (int i = 0; i < 1500; ++i) {
      simulation->advance(1);
      const double now = simulation->report(0).kinetic_energy, height = potential();
      largest_gain = std::max(largest_gain, now + height - energy - level);
      energy = now;
      level = height;
    }
    INFO(name_of(backend) << ": " << start << " J to " << energy << " J, largest gain in a step " << largest_gain);
    CHECK(largest_gain < 1e-4 * start);
    CHECK(energy < 0.5 * start);
    WARN(name_of(backend) << ": sliding: largest gain in a step " << largest_gain / start << " of the start");
  }
}
