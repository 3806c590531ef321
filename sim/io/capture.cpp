#include "sim/io/capture.h"

namespace gonogo::sim {

Capture capture_world(Simulation& simulation, WorldIndex world) {
  Capture capture;
  capture.time = simulation.report(world).time;
  capture.body = simulation.bodies(world);
  const auto contact = simulation.contacts(world);
  const auto impulse = simulation.impulses(world);
  for (std::size_t i = 0; i < contact.size(); ++i) {
    const Contact& c = contact[i];
    const Vec3d point = capture.body[c.body_a].position + static_cast<Vec3d>(c.arm_a);
    capture.contact.push_back({point, c.normal, impulse[i].linear, c.gap, c.body_a, c.body_b});
  }
  return capture;
}

Vec3d centre_of(const Shape& shape, const BodyState& body) {
  return body.position + static_cast<Vec3d>(rotate(body.orientation, shape.offset_B));
}

Vec3 velocity_of(const Shape& shape, const BodyState& body) {
  return body.velocity + cross(body.angular_velocity, rotate(body.orientation, shape.offset_B));
}

}  // namespace gonogo::sim
