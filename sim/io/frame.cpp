#include "sim/io/frame.h"

namespace gonogo::sim {

Frame frame_of(Simulation& simulation, WorldIndex world) {
  Frame frame;
  frame.time = simulation.report(world).time;
  frame.body = simulation.bodies(world);
  const auto contact = simulation.contacts(world);
  const auto impulse = simulation.impulses(world);
  for (std::size_t i = 0; i < contact.size(); ++i) {
    const Contact& c = contact[i];
    const Vec3d point = frame.body[c.body_a].position + static_cast<Vec3d>(c.arm_a);
    frame.contact.push_back({point, c.normal, impulse[i].linear, c.gap, c.body_a, c.body_b});
  }
  return frame;
}

Vec3d centre_of(const Shape& shape, const BodyState& body) {
  return body.position + static_cast<Vec3d>(rotate(body.orientation, shape.offset_B));
}

Vec3 velocity_of(const Shape& shape, const BodyState& body) {
  return body.velocity + cross(body.angular_velocity, rotate(body.orientation, shape.offset_B));
}

}  // namespace gonogo::sim
