// A four-wheel vehicle: chassis, hubs on prismatic joints with springs and dampers, wheels on revolute joints with
// speed motors. The wheels are spheres.
#include <cmath>
#include <string>
#include <vector>

#include "sim/joint/build.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/joint_error.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr double kRadius = 0.4, kHalfBase = 1.5, kHalfTrack = 0.8, kStiffness = 8e4, kDamping = 6e3;
constexpr double kChassisMass = 2000, kHubMass = 30, kWheelMass = 50,
                 kMass = kChassisMass + 4 * (kHubMass + kWheelMass);
constexpr double kCentreX = 0.2, kCentreY = -0.1, kCentreZ = 0.9;  // of the chassis' mass, unloaded

struct Vehicle {
  SceneWorld world;
  BodyIndex chassis = 0, wheel[4] = {};
  Vec3d corner(int k) const { return {k < 2 ? kHalfBase : -kHalfBase, k % 2 ? kHalfTrack : -kHalfTrack, 0}; }
};

Vehicle vehicle(double slope, double torque_limit, double speed = 0) {
  Vehicle v;
  SceneWorld& w = v.world;
  w.origin = {-50, -10, -1};
  w.size = {100, 20, 5};
  w.gravity = tilted_gravity(slope);
  w.set_law(0, 0, {Real(0.9), 0, 0});
  add_plane(w);
  v.chassis = w.add_body({{kCentreX, kCentreY, kCentreZ}, {}, {}, {}}, solid(Real(kChassisMass), {600, 1500, 1800}));
  for (int k = 0; k < 4; ++k) {
    const Vec3d at = v.corner(k) + Vec3d{0, 0, kRadius};
    const BodyIndex hub = w.add_body({at, {}, {}, {}}, solid(Real(kHubMass), {1, 1, 1}));
    const Real inertia = Real(0.5 * kWheelMass * kRadius * kRadius);
    v.wheel[k] = w.add_body({at, {}, {}, {}}, solid(Real(kWheelMass), {inertia, inertia, inertia}));
    Shape tyre;
    tyre.body = v.wheel[k];
    tyre.size = {Real(kRadius), 0, 0};
    w.add_shape(tyre);
    w.joint.push_back(prismatic(w, hub, v.chassis, at, {0, 0, 1}));
    w.spring.push_back(spring_along(w.joint.back(), 0, kStiffness, kDamping));
    w.joint.push_back(revolute(w, v.wheel[k], hub, at, {0, 1, 0}));
    w.motor.push_back(speed_motor(w.joint.back(), speed, torque_limit));
  }
  return v;
}

/// Loads of the wheels normal to the ground: equal springs under a rigid chassis carry what balances the moments about
/// the contact points, for the chassis where it is now; on a slope the weights' parts along it act at their heights.
std::vector<double> static_loads(const Vehicle& v, const std::vector<BodyState>& body, double slope) {
  const double normal = kGravity * std::cos(slope), along = kGravity * std::sin(slope);
  Vec3d middle;
  for (const BodyIndex w : v.wheel) middle += body[w].position * 0.25;
  const Vec3d centre = body[v.chassis].position - middle;
  const double pitch =
      kChassisMass * (normal * centre.x - along * (centre.z + kRadius)) - 4 * (kHubMass + kWheelMass) * along * kRadius;
  const double roll = kChassisMass * normal * centre.y;
  std::vector<double> load;
  for (int k = 0; k < 4; ++k)
    load.push_back(kMass * normal / 4 + pitch * v.corner(k).x / (4 * kHalfBase * kHalfBase) +
                   roll * v.corner(k).y / (4 * kHalfTrack * kHalfTrack));
  return load;
}

void check_loads(Simulation& simulation, const Vehicle& v, double slope, const std::string& name) {
  const auto expected = static_loads(v, simulation.bodies(0), slope);
  simulation.advance(1);
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const double load = simulation.contact_force(0, v.wheel[k]).z;
    CHECK(agrees(name + "load of wheel " + std::to_string(k) + " [N]", expected[k], load, 0.01 * expected[k]));
    sum += load;
  }
  CHECK(agrees(name + "sum of the loads [N]", kMass * kGravity * std::cos(slope), sum, 1e-3 * kMass * kGravity));
  CHECK(agrees(name + "drift [m]", 0, drift(v.world, simulation.bodies(0)), 1e-4));
}

}  // namespace

TEST_CASE("a four-wheel vehicle with an off-centre load stands on its wheels as statics says") {
  for (const Backend backend : backends())
    for (const Index iterations : {30, 50}) {
      const Vehicle v = vehicle(0, 3000);
      const auto simulation = simulate(backend, v.world, settings_with(iterations));
      advance_for(*simulation, 4);
      const std::string name = std::to_string(iterations) + " iterations, ";
      check_loads(*simulation, v, 0, name);
      CHECK(agrees(name + "residual [m/s]", 0, simulation->report(0).max_residual, 1e-4));
      // The chassis sinks by what the springs give, whatever the iteration budget.
      const double sag = kChassisMass * kGravity / (4 * kStiffness);
      const BodyState chassis = simulation->body(0, v.chassis);
      const Vec3d middle = pose_of(chassis).point({Real(-kCentreX), Real(-kCentreY), 0});
      CHECK(agrees(name + "sag of the suspension [m]", sag, kCentreZ - middle.z, 0.01 * sag));
    }
}

TEST_CASE("its brakes hold it on a slope of 15 degrees") {
  const double slope = 15 * kPi / 180;
  for (const Backend backend : backends())
    for (const Index iterations : {30, 50}) {
      const Vehicle v = vehicle(slope, 2000);
      const auto simulation = simulate(backend, v.world, settings_with(iterations));
      advance_for(*simulation, 4);
      const std::string name = "15 degrees, " + std::to_string(iterations) + " iterations, ";
      check_loads(*simulation, v, slope, name);
      double torque = 0;
      for (int k = 0; k < 4; ++k) torque += simulation->motor_torque(0, k);
      CHECK(agrees(name + "sum of the brakes' torques [N m]", kMass * kGravity * std::sin(slope) * kRadius, torque,
                   0.01 * kMass * kGravity * kRadius * std::sin(slope)));
      const double before = simulation->body(0, v.chassis).position.x;
      advance_for(*simulation, 4);
      CHECK(agrees(name + "creep in 4 s [m]", 0, simulation->body(0, v.chassis).position.x - before, 1e-4));
    }
}

TEST_CASE("brakes that are too weak let it roll down with the acceleration that is left") {
  const double slope = 15 * kPi / 180, torque = 300;
  const double inertia = 0.5 * kWheelMass * kRadius * kRadius;
  const double expected =
      (kMass * kGravity * std::sin(slope) - 4 * torque / kRadius) / (kMass + 4 * inertia / (kRadius * kRadius));
  for (const Backend backend : backends()) {
    const Vehicle v = vehicle(slope, torque);
    const auto simulation = simulate(backend, v.world, settings_with(50));
    advance_for(*simulation, 2);
    const double before = simulation->body(0, v.chassis).velocity.x;
    advance_for(*simulation, 1);
    CHECK(agrees("weak brakes, acceleration [m/s^2]", -expected, simulation->body(0, v.chassis).velocity.x - before,
                 0.01 * expected));
  }
}

TEST_CASE("its motors drive it to their speed, and its joints hold") {
  for (const Backend backend : backends()) {
    const Vehicle v = vehicle(0, 400, 10);
    const auto simulation = simulate(backend, v.world, settings_with(40));
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
      simulation->advance(100);
      worst = std::max(worst, drift(v.world, simulation->bodies(0)));
    }
    CHECK(agrees("driving, speed [m/s]", 10 * kRadius, simulation->body(0, v.chassis).velocity.x, 0.02 * 4));
    CHECK(agrees("driving, drift [m]", 0, worst, 1e-4));
    CHECK(simulation->report(0).flags == 0);
  }
}
