// A four-wheel vehicle: chassis, hubs on prismatic joints with springs and dampers, wheels on revolute joints with
// speed motors. The wheels are spheres. All cases are worlds of one batch.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/units.h"
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

constexpr double kRadius = 0.4, kHalfBase = 1.5, kHalfTrack = 0.8, kStiffness = 8e4, kDamping = 6e3;
constexpr double kChassisMass = 2000, kHubMass = 30, kWheelMass = 50,
                 kMass = kChassisMass + 4 * (kHubMass + kWheelMass);
constexpr double kCentreX = 0.2, kCentreY = -0.1, kCentreZ = 0.9;  // of the chassis' mass, unloaded

struct Vehicle {
  SceneWorld world;
  BodyIndex chassis = 0, wheel[4] = {};
  Vec3d corner(int k) const { return {k < 2 ? kHalfBase : -kHalfBase, k % 2 ? kHalfTrack : -kHalfTrack, 0}; }
};

Vehicle vehicle_on(double slope, double torque_limit, double speed = 0) {
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

void check_loads(const Vehicle& v, const std::vector<BodyState>& body, const std::vector<double>& load, double slope,
                 const std::string& name) {
  const auto expected = static_loads(v, body, slope);
  double sum = 0;
  for (std::size_t k = 0; k < load.size(); ++k) {
    CHECK(agrees(name + "load of wheel " + std::to_string(k) + " [N]", expected[k], load[k], 0.01 * expected[k]));
    sum += load[k];
  }
  CHECK(agrees(name + "sum of the loads [N]", kMass * kGravity * std::cos(slope), sum, 1e-3 * kMass * kGravity));
  CHECK(agrees(name + "drift [m]", 0, drift(v.world, body), 1e-4));
}

constexpr double kSlope = to_radians(15), kWeak = 300, kStrong = 2000;  // torques of the brakes per wheel [N m]

/// Four of them in one batch: standing on level ground, held on a slope by its brakes, rolling down it because they are
/// too weak, and driving off.
struct Fleet {
  enum : WorldIndex { standing, held, rolling, driving };
  std::vector<Vehicle> vehicle{vehicle_on(0, 3000), vehicle_on(kSlope, kStrong), vehicle_on(kSlope, kWeak),
                               vehicle_on(0, 400, 10)};
  std::unique_ptr<Simulation> simulation;
  std::string name;

  Fleet(Backend backend, Index iterations) : name(std::to_string(iterations) + " iterations, ") {
    Scene scene;
    for (const Vehicle& v : vehicle) scene.push_back(v.world);
    simulation = make_simulation(backend, scene, settings_with(iterations), 1);
  }

  std::vector<double> loads(WorldIndex w) {
    std::vector<double> load;
    for (const BodyIndex wheel : vehicle[std::size_t(w)].wheel) load.push_back(simulation->contact_force(w, wheel).z);
    return load;
  }
  BodyState chassis(WorldIndex w) { return simulation->body(w, vehicle[std::size_t(w)].chassis); }
  double forward(WorldIndex w) { return double(chassis(w).velocity.x); }
};

/// The suspension has come to rest after 2.5 s: it decays by half in a ninth of a second.
void check_standing(Fleet& f) {
  const auto body = f.simulation->bodies(Fleet::standing);
  check_loads(f.vehicle[Fleet::standing], body, f.loads(Fleet::standing), 0, f.name);
  CHECK(agrees(f.name + "residual [m/s]", 0, f.simulation->report(Fleet::standing).max_residual, 1e-4));
  // The chassis sinks by what the springs give, whatever the iteration budget.
  const double sag = kChassisMass * kGravity / (4 * kStiffness);
  const Vec3d middle = pose_of(f.chassis(Fleet::standing)).point({Real(-kCentreX), Real(-kCentreY), 0});
  CHECK(agrees(f.name + "sag of the suspension [m]", sag, kCentreZ - middle.z, 0.01 * sag));
}

void check_held(Fleet& f) {
  const std::string name = "15 degrees, " + f.name;
  check_loads(f.vehicle[Fleet::held], f.simulation->bodies(Fleet::held), f.loads(Fleet::held), kSlope, name);
  double torque = 0;
  for (int k = 0; k < 4; ++k) torque += f.simulation->motor_torque(Fleet::held, k);
  CHECK(agrees(name + "sum of the brakes' torques [N m]", kMass * kGravity * std::sin(kSlope) * kRadius, torque,
               0.01 * kMass * kGravity * kRadius * std::sin(kSlope)));
}

}  // namespace

TEST_CASE(
    "a four-wheel vehicle stands as statics says, its brakes hold it on 15 degrees or let it roll, its motors drive") {
  const double wheel_inertia = 0.5 * kWheelMass * kRadius * kRadius;
  const double downhill =
      (kMass * kGravity * std::sin(kSlope) - 4 * kWeak / kRadius) / (kMass + 4 * wheel_inertia / (kRadius * kRadius));
  for (const Backend backend : backends())
    for (const Index iterations : {30, 50}) {
      Fleet f(backend, iterations);
      double worst = 0;
      const auto drive = [&](double time) {
        for (int k = 0; k < int(std::lround(time / 0.1)); ++k) {
          f.simulation->advance(100);
          worst = std::max(worst, drift(f.vehicle[Fleet::driving].world, f.simulation->bodies(Fleet::driving)));
        }
      };
      drive(1.5);
      const double before = f.forward(Fleet::rolling);
      drive(1);
      CHECK(agrees(f.name + "weak brakes, acceleration [m/s^2]", -downhill, f.forward(Fleet::rolling) - before,
                   0.01 * downhill));
      check_standing(f);
      check_held(f);
      const double there = f.chassis(Fleet::held).position.x;
      drive(1.5);
      CHECK(agrees(f.name + "creep on 15 degrees in 1.5 s [m]", 0, f.chassis(Fleet::held).position.x - there, 4e-5));
      CHECK(agrees(f.name + "driving, speed [m/s]", 10 * kRadius, f.forward(Fleet::driving), 0.02 * 4));
      CHECK(agrees(f.name + "driving, drift [m]", 0, worst, 1e-4));
      CHECK(f.simulation->report(Fleet::driving).flags == 0);
    }
}
