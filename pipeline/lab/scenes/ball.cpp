#include "pipeline/lab/scenes/ball.h"

#include <algorithm>

#include "pipeline/lab/scenes/ball_in_tank.h"

namespace gonogo::lab {
namespace {

/// Share of a sphere's volume below its equator plus `depth` [m].
double sunk_share(double depth, double radius) {
  const double t = std::clamp(depth / radius, -1.0, 1.0);
  return 0.5 + t * (3 - t * t) / 4;
}

}  // namespace

ManyScene ball_scene(const BallSpec& given, const RunOn& on) {
  BallSpec spec = given;
  spec.tank.of.friction = 0;
  ManyScene scene;
  scene.name = "ball";
  const sim::SceneWorld tank = tank_world(spec.tank, on);
  const double radius = spec.size_ratio * spec.tank.of.diameter / 2;
  const double bulk = spec.tank.of.density * solid_fraction(spec.tank, tank);
  const double surface = tank.size.z - 6 * spec.tank.of.diameter;
  scene.world = with_ball(tank, middle_of(tank) + Vec3d{0, 0, surface}, radius, spec.relative_density * bulk);
  scene.world.size.z += 4 * radius;
  scene.settings = many_step_settings(spec.tank.of, on.iterations, on.solver);
  scene.duration = spec.floated;
  scene.measure = [=, world = scene.world](sim::Simulation& simulation) -> std::vector<Measured> {
    const auto bodies = simulation.bodies(0);
    const double level = surface_of(bodies, spec.tank, world, radius);
    return {{"sunk_share", sunk_share(level - bodies[0].position.z, radius)},
            {"relative_density", spec.relative_density},
            {"speed_m_per_s", double(length(bodies[0].velocity))}};
  };
  return scene;
}

}  // namespace gonogo::lab
