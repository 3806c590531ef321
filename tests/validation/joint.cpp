// Linkages over seconds: periods, energies and drift.
#include <cmath>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/joint_error.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr double kMaxDrift = 1e-4;  // [m, rad], what issue 3 asks of every joint

SceneWorld empty_world() {
  SceneWorld w;
  w.origin = {-10, -10, -10};
  w.size = {20, 20, 20};
  w.add_body({}, fixed_body());
  return w;
}

/// A slender rod of 1 m per kg and its axis, centre and tilt in the xz plane.
BodyIndex add_rod(SceneWorld& w, const Vec3d& from, const Vec3d& to, double mass) {
  const Vec3d along = to - from;
  const double size = length(along), inertia = mass * size * size / 12;
  // Body x along the rod; a little inertia about it.
  const double angle = -std::atan2(along.z, along.x);
  return w.add_body({(from + to) * 0.5, about_y(angle), {}, {}},
                    solid(Real(mass), {Real(0.01 * inertia), Real(inertia), Real(inertia)}));
}

double kinetic(const BodyMass& m, const BodyState& s) {
  const Pose at = pose_of(s);
  const auto v = static_cast<Vec3d>(s.velocity), spin = static_cast<Vec3d>(s.angular_velocity);
  const double x = dot(at.x, spin), y = dot(at.y, spin), z = dot(at.z, spin);
  return 0.5 * (dot(v, v) / m.inverse_mass.x + x * x / m.inverse_inertia_B.x + y * y / m.inverse_inertia_B.y +
                z * z / m.inverse_inertia_B.z);
}

/// Kinetic and potential energy of the moving bodies. Velocities are those of the middle between two positions, so the
/// potential energy is taken there too.
double energy(const SceneWorld& w, const std::vector<BodyState>& before, const std::vector<BodyState>& after) {
  double sum = 0;
  for (std::size_t b = 0; b < w.body.size(); ++b) {
    if (is_fixed(w.mass[b])) continue;
    sum += kinetic(w.mass[b], after[b]) +
           kGravity / w.mass[b].inverse_mass.x * 0.5 * (before[b].position.z + after[b].position.z);
  }
  return sum;
}

struct Swing {
  double energy_error = 0;  // largest deviation from the first [J]
  double drift = 0;         // [m, rad]
  double kinetic = 0;       // largest [J]
};

/// Looks at every tenth step: each look costs a GPU more than a step, and nothing here changes within ten.
constexpr Index kStride = 10;

Swing swing(Backend backend, const SceneWorld& w, double step, double seconds) {
  StepSettings settings;
  settings.step = Real(step);
  const auto simulation = simulate(backend, w, settings);
  simulation->advance(1);
  const double first = energy(w, w.body, simulation->bodies(0));
  Swing result;
  for (Index taken = 1; taken < std::lround(seconds / step); taken += kStride) {
    simulation->advance(kStride - 1);
    const auto before = simulation->bodies(0);
    simulation->advance(1);
    const auto after = simulation->bodies(0);
    result.energy_error = std::max(result.energy_error, std::fabs(energy(w, before, after) - first));
    result.drift = std::max({result.drift, drift(w, before), drift(w, after)});
    result.kinetic = std::max(result.kinetic, simulation->report(0).kinetic_energy);
  }
  CHECK(simulation->report(0).flags == 0);
  return result;
}

}  // namespace

TEST_CASE("a compound pendulum swings with its period and keeps its energy") {
  const double mass = 3, reach = 0.6, inertia = 0.2, amplitude = 0.1;
  for (const Backend backend : backends()) {
    SceneWorld w = empty_world();
    const Vec3d pivot{0, 0, 1};
    const BodyIndex bob =
        w.add_body({pivot + Vec3d{std::sin(amplitude), 0, -std::cos(amplitude)} * reach, about_y(-amplitude), {}, {}},
                   solid(Real(mass), {Real(inertia), Real(inertia), Real(inertia)}));
    w.joint.push_back(revolute(w, bob, 0, pivot, {0, 1, 0}));
    const auto simulation = simulate(backend, w, {});
    std::vector<double> crossing;
    double last = 1;
    for (int i = 1; crossing.size() < 11 && i < 4000; ++i) {
      simulation->advance(kStride);
      const double x = simulation->body(0, bob).position.x;
      // A sine is straight where it crosses zero: to 1e-6 s over ten steps.
      if (last > 0 && x <= 0) crossing.push_back((i - 1 + last / (last - x)) * kStride * 1e-3);
      last = x;
    }
    REQUIRE(crossing.size() == 11);
    const double small = 2 * kPi * std::sqrt((inertia + mass * reach * reach) / (mass * kGravity * reach));
    const double period = small * (1 + amplitude * amplitude / 16), ten = crossing.back() - crossing.front();
    CHECK(agrees("pendulum, period [s]", period, ten / 10, 1e-4 * period));
    const Swing s = swing(backend, w, 1e-3, 10);
    CHECK(agrees("pendulum, energy error over 10 s per swing's energy [-]", 0, s.energy_error / s.kinetic, 2e-3));
    CHECK(agrees("pendulum, drift [m]", 0, s.drift, kMaxDrift));
  }
}

TEST_CASE("a double pendulum that goes over the top keeps its energy") {
  for (const Backend backend : backends())
    for (const double step : {1e-3, 2.5e-4}) {
      SceneWorld w = empty_world();
      const BodyIndex upper = add_rod(w, {0, 0, 0}, {0.5, 0, 0.3}, 1),
                      lower = add_rod(w, {0.5, 0, 0.3}, {0.9, 0, 0.8}, 1);
      w.joint.push_back(revolute(w, upper, 0, {0, 0, 0}, {0, 1, 0}));
      w.joint.push_back(revolute(w, lower, upper, {0.5, 0, 0.3}, {0, 1, 0}));
      const Swing s = swing(backend, w, step, 10);
      const std::string name = "double pendulum, h " + short_text(step) + " s, ";
      CHECK(agrees(name + "energy error over 10 s per largest kinetic energy [-]", 0, s.energy_error / s.kinetic,
                   step > 5e-4 ? 0.02 : 0.005));
      CHECK(agrees(name + "drift [m]", 0, s.drift, kMaxDrift));
    }
}

TEST_CASE("a planar four-bar, whose revolute joints say everything twice, swings and keeps its energy") {
  for (const Backend backend : backends()) {
    SceneWorld w = empty_world();
    const Vec3d a{0, 0, 0}, b{0.3, 0, -0.4}, c{1.0, 0, -0.5}, d{1.1, 0, 0};
    const BodyIndex crank = add_rod(w, a, b, 1), coupler = add_rod(w, b, c, 2), rocker = add_rod(w, c, d, 1);
    w.joint.push_back(revolute(w, crank, 0, a, {0, 1, 0}));
    w.joint.push_back(revolute(w, coupler, crank, b, {0, 1, 0}));
    w.joint.push_back(revolute(w, rocker, coupler, c, {0, 1, 0}));
    w.joint.push_back(revolute(w, rocker, 0, d, {0, 1, 0}));
    const Swing s = swing(backend, w, 1e-3, 10);
    CHECK(s.kinetic > 0.3);  // it swings
    CHECK(
        agrees("four-bar, energy error over 10 s per largest kinetic energy [-]", 0, s.energy_error / s.kinetic, 0.01));
    CHECK(agrees("four-bar, drift [m]", 0, s.drift, kMaxDrift));
  }
}

TEST_CASE("joints hold while a mechanism of every kind is thrown about") {
  for (const Backend backend : backends()) {
    SceneWorld w = empty_world();
    const JointType types[] = {JointType::universal, JointType::spherical, JointType::fixed,
                               JointType::revolute,  JointType::distance,  JointType::prismatic};
    BodyIndex last = 0;
    for (int k = 0; k < 6; ++k) {
      const Vec3d here{0.3 * k, 0, 0}, next{0.3 * (k + 1), 0, 0};
      const BodyIndex rod = add_rod(w, here, next, 1);
      if (types[k] == JointType::universal) w.joint.push_back(universal(w, rod, last, here, {0, 1, 0}, {0, 0, 1}));
      if (types[k] == JointType::spherical) w.joint.push_back(spherical(w, rod, last, here));
      if (types[k] == JointType::fixed) w.joint.push_back(fixed(w, rod, last, here));
      if (types[k] == JointType::revolute) w.joint.push_back(revolute(w, rod, last, here, {0, 0, 1}));
      if (types[k] == JointType::distance) w.joint.push_back(distance(w, rod, last, here, here - Vec3d{0.1, 0, 0}));
      if (types[k] == JointType::prismatic) {
        w.joint.push_back(prismatic(w, rod, last, here, {1, 0, 0}));
        w.spring.push_back(spring_along(w.joint.back(), 0, 500, 5));
      }
      last = rod;
    }
    const Swing s = swing(backend, w, 1e-3, 5);
    CHECK(agrees("mechanism of every joint, drift [m]", 0, s.drift, kMaxDrift));
  }
}

TEST_CASE("a chain of light links carries a thousand times heavier weight") {
  for (const Backend backend : backends()) {
    SceneWorld w = empty_world();
    BodyIndex last = 0;
    const int links = 10;
    for (int k = 0; k < links; ++k) {
      const BodyIndex link = add_rod(w, {0, 0, -0.2 * k}, {0, 0, -0.2 * (k + 1)}, 1);
      w.joint.push_back(spherical(w, link, last, {0, 0, -0.2 * k}));
      last = link;
    }
    const BodyIndex weight =
        w.add_body({{0, 0, -0.2 * links - 0.3}, {}, {Real(0.5), 0, 0}, {}}, solid(1000, {50, 50, 50}));
    w.joint.push_back(spherical(w, weight, last, {0, 0, -0.2 * links}));
    const Swing s = swing(backend, w, 1e-3, 3);
    CHECK(agrees("chain 1000 : 1, drift [m]", 0, s.drift, kMaxDrift));
    w.body[weight].velocity = {};
    const auto simulation = simulate(backend, w, {});
    advance_for(*simulation, 1);
    const double expected = (1000 + links) * kGravity;
    CHECK(agrees("chain 1000 : 1, force on the uppermost joint [N]", expected, simulation->joint_load(0, 0).force.z,
                 1e-4 * expected));
  }
}

TEST_CASE("a spring far stiffer than the step can follow is stable and sags by m g / k") {
  const double mass = 100;
  for (const Backend backend : backends())
    for (const double stiffness : {1e4, 1e8, 1e12}) {
      SceneWorld w = empty_world();
      const BodyIndex b = w.add_body({{0, 0, -1}, {}, {}, {}}, solid(Real(mass), {1, 1, 1}));
      w.spring.push_back(spring_between(w, b, 0, {0, 0, -1}, {}, stiffness, 2 * std::sqrt(stiffness * mass)));
      const auto simulation = simulate(backend, w, {});
      double highest = -2;
      for (int i = 0; i < 100; ++i) {
        simulation->advance(40);
        highest = std::max(highest, simulation->body(0, b).position.z);
      }
      const double sag = mass * kGravity / stiffness, z = simulation->body(0, b).position.z;
      CHECK(agrees("spring of " + short_text(stiffness) + " N/m, sag [m]", sag, -1 - z, 1e-3 * sag + 1e-12));
      CHECK(agrees("  the same, force [N]", mass * kGravity, simulation->spring_load(0, 0).force.z,
                   1e-3 * mass * kGravity));
      CHECK(highest < -1 + 1e-9);
    }
}

TEST_CASE("springs that share a body act exactly together") {
  // Three springs in a row and two beside each other between ground and two masses: static stretches in closed form.
  const double m = 20, k = 5e3;
  for (const Backend backend : backends()) {
    SceneWorld w = empty_world();
    const BodyIndex a = w.add_body({{0, 0, -1}, {}, {}, {}}, solid(Real(m), {1, 1, 1}));
    const BodyIndex b = w.add_body({{0, 0, -2}, {}, {}, {}}, solid(Real(m), {1, 1, 1}));
    w.spring.push_back(spring_along(w, a, 0, {0, 0, -1}, {}, {0, 0, 1}, k, 100));
    w.spring.push_back(spring_along(w, a, 0, {0, 0, -1}, {}, {0, 0, 1}, 2 * k, 100));
    w.spring.push_back(spring_along(w, b, a, {0, 0, -2}, {0, 0, -1}, {0, 0, 1}, k, 200));
    const auto simulation = simulate(backend, w, {});
    advance_for(*simulation, 10);
    const double upper = 2 * m * kGravity / (3 * k), lower = m * kGravity / k;
    CHECK(agrees("springs together, upper stretch [m]", upper, -1 - simulation->body(0, a).position.z, 1e-5 * upper));
    CHECK(
        agrees("springs together, lower sag [m]", upper + lower, -2 - simulation->body(0, b).position.z, 1e-5 * lower));
  }
}

TEST_CASE("a bump stop's table carries the static load on its steep part") {
  const double mass = 500;
  for (const Backend backend : backends()) {
    SceneWorld w = empty_world();
    const BodyIndex b = w.add_body({{0, 0, 1}, {}, {}, {}}, solid(Real(mass), {1, 1, 1}));
    w.joint.push_back(prismatic(w, b, 0, {0, 0, 1}, {0, 0, 1}));
    SpringDamper s = spring_along(w.joint[0], 0, 0, 3000);
    s.table = force_table({{-0.10, -1000.0 - 0.05 * 1e6}, {-0.05, -1000}, {0, 0}});  // soft, then a stop
    w.spring.push_back(s);
    const auto simulation = simulate(backend, w, {});
    advance_for(*simulation, 5);
    const double expected = 1 - 0.05 - (mass * kGravity - 1000) / 1e6;
    CHECK(agrees("bump stop, height [m]", expected, simulation->body(0, b).position.z, 1e-6));
    const double into_stop = (mass * kGravity - 1000) / 1e6;
    const double held = 0.5 * 1000 * 0.05 + 1000 * into_stop + 0.5 * 1e6 * into_stop * into_stop;
    CHECK(agrees("bump stop, energy in the spring [J]", held, simulation->report(0).spring_energy, 1e-3 * held));
    CHECK(agrees("bump stop, force [N]", mass * kGravity, simulation->spring_load(0, 0).force.z, 1));
  }
}

TEST_CASE("a torsion bar swings a lever with its period") {
  const double inertia = 2, stiffness = 300;
  for (const Backend backend : backends()) {
    SceneWorld w = empty_world();
    w.gravity = {};
    const BodyIndex b = w.add_body({}, solid(1, {Real(inertia), Real(inertia), Real(inertia)}));
    w.joint.push_back(revolute(w, b, 0, {}, {1, 2, 2}));
    w.spring.push_back(spring_about(w.joint[0], 0.5, stiffness, 0));
    StepSettings settings;
    settings.step = 1e-4f;
    const auto simulation = simulate(backend, w, settings);
    const double period = 2 * kPi * std::sqrt(inertia / stiffness);
    advance_for(*simulation, period / 2);
    const Quat q = simulation->body(0, b).orientation;
    const double angle = 2 * std::atan2((q.x + 2 * q.y + 2 * q.z) / 3, q.w);
    // From rest at 0 it swings to twice the free angle; the implicit step damps by w^2 h / 2.
    const double decay = std::exp(-stiffness / inertia * 1e-4 / 2 * period / 2);
    CHECK(agrees("torsion bar, angle after half a period [rad]", 0.5 + 0.5 * decay, angle, 1e-3));
  }
}
