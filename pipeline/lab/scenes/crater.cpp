#include "pipeline/lab/scenes/crater.h"

#include <cmath>

#include "base/units.h"
#include "pipeline/lab/scenes/ball_in_tank.h"

namespace gonogo::lab {

ManyScene crater_scene(const CraterSpec& spec, const RunOn& on) {
  ManyScene scene;
  scene.name = "crater";
  const sim::SceneWorld tank = tank_world(spec.tank, on);
  const double radius = spec.size_ratio * spec.tank.of.diameter / 2, grain = spec.tank.of.diameter / 2;
  // With the ball far above, nothing is taken out and nothing left out.
  const Vec3d above = middle_of(tank) + Vec3d{0, 0, 1e3};
  const double surface = surface_of(with_ball(tank, above, radius, spec.density).body, spec.tank, tank, -1e3) + grain;
  scene.world = with_ball(tank, middle_of(tank) + Vec3d{0, 0, surface + grain + radius}, radius, spec.density);
  scene.world.body[0].velocity.z = Real(-std::sqrt(2 * kGravity * spec.drop_height));
  scene.world.size.z += 4 * radius;
  scene.settings = many_step_settings(spec.tank.of, on.iterations, on.solver);
  scene.duration = spec.watched;
  scene.measure = [=](sim::Simulation& simulation) -> std::vector<Measured> {
    const double depth = surface - (simulation.body(0, 0).position.z - radius);
    return {{"depth_m", depth}, {"total_fall_m", spec.drop_height + depth}};
  };
  return scene;
}

}  // namespace gonogo::lab
