#include "vehicle/wheel_rig.h"

#include <cmath>

#include "base/error.h"
#include "sim/scene/build_joint.h"
#include "vehicle/model/read.h"

namespace gonogo::vehicle {
namespace {

void read_wheel(const Config& wheel, WheelRig& rig) {
  rig.radius = wheel.number("radius_m", {0.01, 5});
  rig.width = wheel.number("width_m", {0.005, 3});
  rig.lug_count = int(wheel.integer_or("lug_count", 0, {0, 200}));
  rig.lug_height = wheel.number_or("lug_height_m", 0, {0, 0.5});
  rig.lug_thickness = wheel.number_or("lug_thickness_m", 0.03, {1e-3, 0.5});
  rig.axle_moment = wheel.number("axle_moment_kg_m2", {1e-6, 1e5});
  rig.compliant = read_tyre_spring(wheel);
  wheel.finish();
}

}  // namespace

WheelRig read_wheel_rig(const std::filesystem::path& path) { return read_wheel_rig(Config::read(path)); }

WheelRig read_wheel_rig(const Config& c) {
  WheelRig rig;
  rig.name = c.text("vehicle");
  c.choice("kind", {"quarter"});
  c.text_or("about", "");
  c.text_or("sources", "");
  read_wheel(c.object("wheel"), rig);
  rig.hub_mass = c.number("hub_mass_kg", {0.01, 1e5});
  rig.sprung_mass = c.number("sprung_mass_kg", {0.01, 1e6});
  rig.wheels_per_vehicle = int(c.integer("wheels_per_vehicle", {1, 100}));
  const Config suspension = c.object("suspension");
  rig.spring_stiffness = suspension.number("stiffness_N_m", {1, 1e9});
  rig.spring_damping = suspension.number("damping_N_s_m", {0, 1e8});
  suspension.finish();
  const Config drive = c.object("drive");
  rig.max_torque = drive.number("max_torque_N_m", {0.001, 1e7});
  drive.finish();
  rig.vehicle_length = c.number("vehicle_length_m", {0.05, 50});
  rig.ground_clearance = c.number("ground_clearance_m", {0, 5});
  c.finish();
  return rig;
}

double rig_mass(const WheelRig& rig, double payload) {
  return rig.hub_mass + rig.sprung_mass + payload / rig.wheels_per_vehicle;
}

RigBodies add_wheel_rig(sim::SceneWorld& world, const WheelRig& rig, const Vec3d& axle, double payload,
                        int tool_material, double yaw) {
  const double carried = rig.sprung_mass + payload / rig.wheels_per_vehicle;
  const auto along = Real(1 / rig_mass(rig, payload));
  sim::BodyMass hub;
  hub.inverse_mass = {along, along, Real(1 / rig.hub_mass)};
  hub.inverse_inertia_B = {0, Real(1 / rig.axle_moment), 0};
  hub.isotropic = 0;
  sim::BodyMass sprung;
  sprung.inverse_mass = {0, 0, Real(1 / carried)};
  const RigBodies bodies{world.add_body({axle, {Real(std::cos(yaw / 2)), 0, 0, Real(std::sin(yaw / 2))}, {}, {}}, hub),
                         world.add_body({axle + Vec3d{0, 0, 1}, {}, {}, {}}, sprung), Index(world.motor.size())};
  sim::Shape shape;
  shape.type = sim::ShapeType::wheel;
  shape.body = bodies.wheel;
  shape.material = tool_material;
  shape.size = {Real(rig.radius), Real(rig.width / 2), Real(rig.lug_height)};
  shape.lug_count = rig.lug_count;
  shape.lug_thickness = Real(rig.lug_thickness);
  world.add_shape(shape);
  const Vec3d axis{0 - std::sin(yaw), std::cos(yaw), 0};
  world.motor.push_back(sim::speed_motor(world, bodies.wheel, sim::kWorld, axis, 0, rig.max_torque));
  // Along the sprung mass's axis, which keeps upright while the wheel turns and runs ahead.
  world.spring.push_back(sim::spring_along(world, bodies.wheel, bodies.sprung, axle, axle + Vec3d{0, 0, 1}, {0, 0, -1},
                                           rig.spring_stiffness, rig.spring_damping));
  return bodies;
}

}  // namespace gonogo::vehicle
