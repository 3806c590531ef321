#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/units.h"
#include "pipeline/lab/scenes/scene.h"
#include "sim/scene/critical_step.h"
#include "sim/scene/penalty_material.h"

namespace gonogo::lab {
namespace {

/// Of the smallest sphere that moves.
struct Smallest {
  double radius = std::numeric_limits<double>::infinity(), density = 0;
};

Smallest smallest_sphere(const sim::SceneWorld& world) {
  Smallest found;
  for (const sim::Shape& s : world.shape) {
    const double inverse = world.mass[s.body].inverse_mass.x, radius = s.size.x;
    if (s.type != sim::ShapeType::sphere || !(inverse > 0) || radius >= found.radius) continue;
    found = {radius, 3 / (4 * kPi * radius * radius * radius * inverse)};
  }
  return found;
}

}  // namespace

void set_penalty(ManyScene& scene, const Softness& softness) {
  sim::StepSettings& s = scene.settings;
  if (!sim::is_penalty(s.solver)) return;
  const Smallest sphere = smallest_sphere(scene.world);
  if (!(sphere.density > 0)) throw InputError(scene.name + ": penalty contact needs a sphere that moves");
  const double speed = std::sqrt(2 * kGravity * scene.world.size.z);
  s.penalty = sim::law_of_overlap(softness.overlap, speed, sphere.radius, sphere.density, softness.restitution);
  s.envelope = 0;  // only overlaps push
  s.cohesion_range = 0;
  s.step = Real(softness.share_of_step * sim::critical_step(scene.world, s).step);
}

}  // namespace gonogo::lab
