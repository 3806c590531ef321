#include "pipeline/lab/scenes/nut.h"

#include <cmath>

#include "base/units.h"
#include "pipeline/lab/scenes/ball_in_tank.h"

namespace gonogo::lab {

ManyScene nut_scene(const NutSpec& spec, const RunOn& on) {
  ManyScene scene;
  scene.name = "nut";
  const sim::SceneWorld tank = tank_world(spec.tank, on);
  const double radius = spec.size_ratio * spec.tank.of.diameter / 2;
  scene.world = with_ball(tank, middle_of(tank) + Vec3d{0, 0, radius}, radius, spec.tank.of.density);
  scene.world.size.z *= 2;  // what is thrown up
  scene.settings = many_step_settings(spec.tank.of, on.iterations, on.solver);
  scene.duration = spec.shaken;
  scene.drive = [spec](sim::Simulation& simulation, double time) {
    const double phase = 2 * kPi * spec.frequency * time;
    simulation.set_gravity(0, {0, 0, Real(-kGravity * (1 + spec.acceleration * std::sin(phase)))});
  };
  const double before = scene.world.body[0].position.z / surface_of(scene.world.body, spec.tank, scene.world, radius);
  scene.measure = [=, world = scene.world](sim::Simulation& simulation) -> std::vector<Measured> {
    const auto bodies = simulation.bodies(0);
    return {{"height_over_depth_start", before},
            {"height_over_depth_end", bodies[0].position.z / surface_of(bodies, spec.tank, world, radius)}};
  };
  return scene;
}

}  // namespace gonogo::lab
