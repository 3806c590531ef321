#include "pipeline/lab/scenes/ball_in_tank.h"

#include <algorithm>
#include <cmath>

namespace gonogo::lab {

sim::SceneWorld with_ball(const sim::SceneWorld& tank, const Vec3d& centre, double radius, double density) {
  sim::SceneWorld world = tank;
  world.body.clear();
  world.mass.clear();
  world.shape.clear();
  world.add_sphere(centre, Real(radius), Real(density), 0);
  std::size_t next = 0;
  for (std::size_t b = 0; b < tank.body.size(); ++b) {
    const bool is_sphere = tank.shape[next].type == sim::ShapeType::sphere;
    const Vec3d apart = tank.body[b].position - centre;
    const double reach = radius + double(tank.shape[next].size.x);
    const bool stays = !is_sphere || dot(apart, apart) > reach * reach;
    const sim::BodyIndex body = stays ? world.add_body(tank.body[b], tank.mass[b]) : 0;
    for (; next < tank.shape.size() && tank.shape[next].body == sim::BodyIndex(b); ++next) {
      sim::Shape s = tank.shape[next];
      s.body = body;
      if (stays) world.add_shape(s);
    }
  }
  return world;
}

Vec3d middle_of(const sim::SceneWorld& world) {
  return {world.origin.x + world.size.x / 2, world.origin.y + world.size.y / 2, 0};
}

double surface_of(const std::vector<sim::BodyState>& bodies, const TankSpec& tank, const sim::SceneWorld& world,
                  double ball_radius) {
  const double width = 2 * tank.of.diameter;
  const auto columns = std::int64_t(world.size.x / width) + 1;
  std::vector<double> top(std::size_t(columns * columns), -1);
  for (std::size_t b = 1; b + 1 < bodies.size(); ++b) {
    const Vec3d& p = bodies[b].position;
    const auto x = std::clamp<std::int64_t>(std::int64_t((p.x - world.origin.x) / width), 0, columns - 1);
    const auto y = std::clamp<std::int64_t>(std::int64_t((p.y - world.origin.y) / width), 0, columns - 1);
    if (std::hypot(p.x - bodies[0].position.x, p.y - bodies[0].position.y) < ball_radius + width) continue;
    double& highest = top[std::size_t(y * columns + x)];
    highest = std::max(highest, p.z);
  }
  double sum = 0, count = 0;
  for (const double z : top)
    if (z >= 0) {
      sum += z;
      ++count;
    }
  return sum / count;
}

}  // namespace gonogo::lab
