#include "pipeline/lab/scenes/spheres.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "base/units.h"

namespace gonogo::lab {

std::vector<Sphere> loose_lattice(const Spheres& spec, const Vec3d& corner, Index nx, Index ny, Index nz,
                                  const std::function<bool(const Vec3d&)>& inside, std::size_t max_count) {
  std::vector<Sphere> spheres;
  std::uint64_t draw = 0;
  const auto between = [&](double low, double high) { return low + (high - low) * random_unit(spec.seed, 0, draw++); };
  const double pitch = spec.pitch(), aside = 0.005 * spec.largest_diameter();
  for (Index z = 0; z < nz; ++z)
    for (Index y = 0; y < ny; ++y)
      for (Index x = 0; x < nx; ++x) {
        const double dx = between(-aside, aside), dy = between(-aside, aside), size = between(-1, 1);
        const Vec3d at = corner + Vec3d{(x + 0.5) * pitch + dx, (y + 0.5) * pitch + dy, (z + 0.5) * pitch};
        if (spheres.size() < max_count && inside(at))
          spheres.push_back({at, spec.diameter / 2 * (1 + spec.size_spread * size)});
      }
  return spheres;
}

sim::StepSettings many_step_settings(const Spheres& spec, int iterations, sim::Solver solver) {
  sim::StepSettings s;
  s.step = Real(2e-3);
  s.iterations = iterations;
  s.solver = solver;
  s.envelope = Real(0.06 * spec.diameter);
  s.recovery_speed = Real(std::sqrt(kGravity * spec.diameter) / 10);
  return s;
}

void add_plane(sim::SceneWorld& world, sim::BodyIndex body, const Vec3d& at, const Quat& turn) {
  sim::Shape plane;
  plane.type = sim::ShapeType::plane;
  plane.body = body;
  plane.offset_B = static_cast<Vec3>(at);
  plane.turn_B = turn;
  world.add_shape(plane);
}

Quat towards(int axis, double sign) {
  const Real c = Real(std::sqrt(0.5)), s = Real(sign * std::sqrt(0.5));
  return axis == 0 ? Quat{c, 0, s, 0} : Quat{c, -s, 0, 0};
}

double fall_time(double height) { return std::sqrt(2 * height / kGravity); }

double height_of(const std::vector<Sphere>& spheres) {
  double height = 0;
  for (const Sphere& s : spheres) height = std::max(height, s.centre.z + s.radius);
  return height;
}

}  // namespace gonogo::lab
