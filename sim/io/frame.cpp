#include "sim/io/frame.h"

namespace gonogo::sim {

Frame frame_of(Simulation& simulation, WorldIndex world) {
  Frame frame;
  frame.time = simulation.report(world).time;
  frame.body = simulation.bodies(world);
  BodyIndex first = 0;
  for (WorldIndex w = 0; w < world; ++w) first += BodyIndex(simulation.bodies(w).size());
  const auto contact = simulation.contacts();
  const auto impulse = simulation.impulses();
  const auto gap = simulation.gaps();
  for (std::size_t i = 0; i < contact.size(); ++i) {
    const Contact& c = contact[i];
    if (c.world != world) continue;
    const BodyIndex a = c.body_a - first, b = c.body_b - first;
    const Vec3d point = frame.body[a].position + static_cast<Vec3d>(c.arm_a);
    frame.contact.push_back({point, c.normal, impulse[i].linear, gap[i], a, b});
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
