// Laws of a contact beyond sliding friction: resistance to spinning, compliance, and Coulomb's law without the lift of
// the convex relaxation.
#include <cmath>
#include <string>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr double kRadius = 0.05;   // [m]
constexpr double kDensity = 2000;  // [kg/m^3]
constexpr double kMass = kDensity * 4 / 3 * kPi * kRadius * kRadius * kRadius;

/// A sphere at rest on a level plane.
SceneWorld sphere_on_plane(const PairLaw& law) {
  SceneWorld w;
  w.origin = {-20, -1, -1};
  w.size = {40, 2, 3};
  w.set_law(0, 0, law);
  add_plane(w);
  w.add_sphere({0, 0, kRadius}, Real(kRadius), Real(kDensity), 0);
  return w;
}

}  // namespace

TEST_CASE("a spinning sphere slows down by 5 c g / (2 r) and stays where it is") {
  const double coefficient = 0.1, spin = 30, seconds = 0.5;
  PairLaw law{Real(0.5), 0, 0};
  law.spinning_friction = Real(coefficient);
  // The moment of the normal force m g is c r m g, the moment of inertia 2/5 m r^2.
  const double slowing = 2.5 * coefficient * kGravity / kRadius;
  for (const Backend backend : backends()) {
    SceneWorld w = sphere_on_plane(law);
    w.body[1].angular_velocity.z = Real(spin);
    const auto simulation = simulate(backend, w, settings_with(1e-3, 100));
    advance_for(*simulation, seconds);
    const BodyState s = simulation->body(0, 1);
    const std::string label = std::string(", ") + name_of(backend);
    CHECK(agrees("spinning sphere, spin [rad/s]" + label, spin - slowing * seconds, s.angular_velocity.z, 1e-3 * spin));
    CHECK(agrees("spinning sphere, distance [m]" + label, 0, std::hypot(s.position.x, s.position.y), 1e-6));
    advance_for(*simulation, spin / slowing);
    CHECK(agrees("spinning sphere at rest, spin [rad/s]" + label, 0, simulation->body(0, 1).angular_velocity.z, 1e-4));
  }
}

TEST_CASE("a compliant contact rests at the overlap m g / k and swings with the period of its spring") {
  const double stiffness = 2000;
  PairLaw law{Real(0.5), 0, 0};
  law.stiffness = Real(stiffness);
  law.damping = Real(0.6 * std::sqrt(stiffness * kMass));
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, sphere_on_plane(law), settings_with(2e-4, 100));
    advance_for(*simulation, 2);
    const double sag = kRadius - simulation->body(0, 1).position.z, expected = kMass * kGravity / stiffness;
    CHECK(agrees(std::string("compliant contact, overlap [m], ") + name_of(backend), expected, sag, 1e-3 * expected));
    CHECK(simulation->contact_force(0, 1).z == Approx(kMass * kGravity).epsilon(1e-3));
  }
  // Without damping and never unloaded it oscillates; a small step keeps the damping of the implicit scheme small.
  law.damping = 0;
  for (const Backend backend : backends()) {
    SceneWorld w = sphere_on_plane(law);
    const double sag = kMass * kGravity / stiffness, frequency = std::sqrt(stiffness / kMass), step = 1e-4;
    w.body[1].position.z -= 0.5 * sag;
    const auto simulation = simulate(backend, w, settings_with(step, 100));
    const double half_period = kPi / frequency;
    advance_for(*simulation, half_period);
    const double decay = std::exp(-frequency * frequency * step / 2 * half_period);
    CHECK(agrees(std::string("compliant contact after half a period, overlap [m], ") + name_of(backend),
                 sag * (1 + 0.5 * decay), kRadius - simulation->body(0, 1).position.z, 0.01 * sag));
  }
}

TEST_CASE("under Coulomb's law a sliding sphere keeps to the plane and loses mu g") {
  // The convex relaxation lifts it by h mu v instead; see sphere.cpp.
  const double mu = 0.5, speed = 2, seconds = 0.05;
  for (const Backend backend : backends()) {
    SceneWorld w = sphere_on_plane({Real(mu), 0, 0});
    w.body[1].velocity.x = Real(speed);
    const auto simulation = simulate(backend, w, settings_with(1e-3, 100, Target::coulomb));
    advance_for(*simulation, seconds);
    const BodyState s = simulation->body(0, 1);
    const std::string label = std::string(", ") + name_of(backend);
    CHECK(agrees("sliding sphere, Coulomb, gap [m]" + label, 0, s.position.z - kRadius, 1e-7));
    CHECK(agrees("sliding sphere, Coulomb, speed [m/s]" + label, speed - mu * kGravity * seconds, s.velocity.x,
                 1e-4 * speed));
    CHECK(simulation->report(0).max_residual < 1e-4);
  }
}
