#include "pipeline/lab/scenes/collapse.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/units.h"
#include "sim/shape/meshes.h"

namespace gonogo::lab {
namespace {

/// Smooth, so that the column has no arches.
sim::BodyIndex add_tube(sim::SceneWorld& world, const CollapseSpec& spec, double height) {
  const auto r = Real(spec.radius()), t = Real(3 * spec.of.diameter), h = Real(height);
  return add_wall(world, sim::revolved_mesh({{r, 0}, {r + t, 0}, {r + t, h}, {r, h}}, kSegments), 1);
}

double mean_height(const std::vector<sim::BodyState>& bodies, std::size_t spheres) {
  double sum = 0;
  for (std::size_t b = 0; b < spheres; ++b) sum += bodies[b].position.z;
  return sum / double(spheres);
}

/// Outer radius of the outermost ring, a diameter wide, half of whose ground lies under spheres, seen from above as if
/// none lay on another [m].
double covered_radius(const std::vector<sim::BodyState>& bodies, std::size_t spheres, double diameter) {
  std::vector<double> cover;  // [ring] area of the spheres over the area of the ring
  for (std::size_t b = 0; b < spheres; ++b) {
    const auto ring = std::size_t(std::hypot(bodies[b].position.x, bodies[b].position.y) / diameter);
    if (ring >= cover.size()) cover.resize(ring + 1, 0.0);
    cover[ring] += 0.25 / (2 * double(ring) + 1);
  }
  std::size_t rings = cover.size();
  while (rings > 0 && cover[rings - 1] < 0.5) --rings;
  return double(rings) * diameter;
}

/// Distance from the axis that this share of the spheres keeps within [m].
double radius_within(const std::vector<sim::BodyState>& bodies, std::size_t spheres, double share) {
  std::vector<double> distance;
  for (std::size_t b = 0; b < spheres; ++b) distance.push_back(std::hypot(bodies[b].position.x, bodies[b].position.y));
  const auto at = distance.begin() + std::ptrdiff_t(share * double(spheres));
  std::nth_element(distance.begin(), at, distance.end());
  return *at;
}

}  // namespace

/// N pi d^3 / 6 = packed pi r^3 aspect.
double CollapseSpec::radius() const { return of.diameter * std::cbrt(double(of.count) / (6 * kPacked * aspect)); }

ManyScene collapse_scene(const CollapseSpec& spec, const RunOn& on) {
  const std::vector<Sphere> column = loose_column(spec.of, spec.radius());
  const std::size_t spheres = column.size();
  const double height = height_of(column), radius = spec.radius(), reach = 8 * radius + 3 * height;
  ManyScene scene{.name = "collapse", .settings = many_step_settings(spec.of, on.iterations, on.solver)};
  sim::SceneWorld& world = scene.world;
  world.origin = {-reach, -reach, -spec.of.diameter};
  world.size = {2 * reach, 2 * reach, height + spec.of.diameter};
  world.set_law(0, 0, {Real(kSettlingFriction), 0, 0});
  for (const Sphere& s : column) world.add_sphere(s.centre, Real(s.radius), Real(spec.of.density), 0);
  add_plane(world, world.add_body({}, sim::fixed_body()), {}, {});
  world.shape.back().group = 1;
  const sim::BodyIndex wall = add_tube(world, spec, height);
  const double falls = 3 * fall_time(height / 3);
  scene.duration = falls + spec.spread_time;
  const auto column_height = std::make_shared<double>(0);
  scene.drive = [=](sim::Simulation& simulation, double time) {
    if (time < falls || *column_height > 0) return;
    *column_height = 2 * mean_height(simulation.bodies(0), spheres);
    simulation.set_law(0, 0, 0, {Real(spec.of.friction), Real(spec.rolling_friction), 0});
    sim::BodyState away = simulation.body(0, wall);
    away.position.z = 100 * height;
    simulation.set_body(0, wall, away);
  };
  scene.measure = [=](sim::Simulation& simulation) -> std::vector<SceneNumber> {
    const auto bodies = simulation.bodies(0);
    double top = 0;
    for (std::size_t b = 0; b < spheres; ++b)
      if (std::hypot(bodies[b].position.x, bodies[b].position.y) < radius / 2)
        top = std::max(top, bodies[b].position.z);
    return {{"aspect", *column_height / radius},
            {"run_out_covered", covered_radius(bodies, spheres, spec.of.diameter) / radius - 1},
            {"run_out_of_99_in_100", radius_within(bodies, spheres, 0.99) / radius - 1},
            {"height_over_radius", top / radius}};
  };
  return scene;
}

}  // namespace gonogo::lab
