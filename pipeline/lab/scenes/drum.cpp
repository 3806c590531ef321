#include "pipeline/lab/scenes/drum.h"

#include <array>
#include <cmath>
#include <map>

#include "base/units.h"
#include "sim/shape/meshes.h"

namespace gonogo::lab {
namespace {

constexpr double kCubeDiameters = 3;  // edge of a sample: about 30 spheres
constexpr std::size_t kMinInCube = 10;
constexpr double kLooksPerTurn = 8;

/// Half of the drum is full: N pi d^3 / 6 = 0.6 pi r^2 l / 2.
double radius_of(const DrumSpec& spec) {
  return spec.of.diameter * std::cbrt(double(spec.of.count) / (1.8 * spec.length_over_radius));
}

double speed_of(const DrumSpec& spec) { return std::sqrt(spec.froude * kGravity / radius_of(spec)); }

std::vector<Sphere> loose_fill(const DrumSpec& spec, double radius, double length) {
  const double inside = radius * std::cos(kPi / kSegments) - spec.of.largest_diameter() / 2, pitch = spec.of.pitch();
  const auto across = Index(std::ceil(2 * radius / pitch)), along = Index(std::floor(length / pitch));
  return loose_lattice(
      spec.of, {-across * pitch / 2, -along * pitch / 2, -across * pitch / 2}, across, along, across,
      [&](const Vec3d& p) { return p.x * p.x + p.z * p.z < inside * inside; }, std::size_t(spec.of.count));
}

/// The rim turns, the caps stand still.
void add_drum(sim::SceneWorld& world, const DrumSpec& spec, double radius, double length) {
  const auto r = Real(radius), t = Real(3 * spec.of.diameter), half = Real(length / 2 + spec.of.diameter);
  sim::Shape rim;
  rim.type = sim::ShapeType::mesh;
  rim.surface = world.add_mesh(sim::revolved_mesh({{r, -half}, {r + t, -half}, {r + t, half}, {r, half}}, kSegments));
  rim.turn_B = towards(1, 1);  // the mesh's axis, z, along y
  rim.group = rim.material = 1;
  rim.body = world.add_body({{}, {}, {}, {0, Real(speed_of(spec)), 0}}, sim::fixed_body());
  world.add_shape(rim);
  const sim::BodyIndex caps = world.add_body({}, sim::fixed_body());
  for (const double sign : {1.0, -1.0}) {
    add_plane(world, caps, {0, -sign * length / 2, 0}, towards(1, sign));
    world.shape.back().group = 1;
    world.shape.back().material = 2;  // smooth
  }
}

}  // namespace

double lacey_index(const std::vector<Vec3d>& position, const std::vector<bool>& is_first, double cube) {
  std::map<std::array<std::int64_t, 3>, std::array<std::size_t, 2>> count;  // all, of the first kind
  for (std::size_t i = 0; i < position.size(); ++i) {
    const Vec3d& p = position[i];
    auto& c = count[{std::int64_t(std::floor(p.x / cube)), std::int64_t(std::floor(p.y / cube)),
                     std::int64_t(std::floor(p.z / cube))}];
    ++c[0];
    c[1] += is_first[i];
  }
  double all = 0, first = 0, cubes = 0;
  for (const auto& [at, c] : count)
    if (c[0] >= kMinInCube) {
      all += double(c[0]);
      first += double(c[1]);
      ++cubes;
    }
  const double p = first / all, n = all / cubes;
  double variance = 0;
  for (const auto& [at, c] : count)
    if (c[0] >= kMinInCube) variance += double(c[0]) / all * std::pow(double(c[1]) / double(c[0]) - p, 2);
  return (p * (1 - p) - variance) / (p * (1 - p) * (1 - 1 / n));
}

ManyScene drum_scene(const DrumSpec& spec, const RunOn& on) {
  const double radius = radius_of(spec), length = spec.length_over_radius * radius,
               reach = radius + 4 * spec.of.diameter;
  ManyScene scene{.name = "drum", .settings = many_step_settings(spec.of, on.iterations, on.solver)};
  sim::SceneWorld& world = scene.world;
  world.origin = {-reach, -length, -reach};
  world.size = {2 * reach, 2 * length, 2 * reach};
  world.set_law(0, 0, {Real(spec.of.friction), 0, 0});
  world.set_law(0, 1, {Real((spec.of.friction + spec.other_friction) / 2), 0, 0});
  world.set_law(1, 1, {Real(spec.other_friction), 0, 0});
  std::vector<bool> is_first;
  for (const Sphere& s : loose_fill(spec, radius, length)) {
    is_first.push_back(s.centre.x < 0);
    world.add_sphere(s.centre, Real(s.radius), Real(spec.of.density), is_first.back() ? 0 : 1);
  }
  add_drum(world, spec, radius, length);
  scene.duration = spec.turns * 2 * kPi / speed_of(spec);
  scene.show_by_material = true;
  const double cube = kCubeDiameters * spec.of.diameter, turns_per_second = speed_of(spec) / (2 * kPi);
  const auto index = [is_first, cube](sim::Simulation& simulation) {
    std::vector<Vec3d> position;
    for (const sim::BodyState& b : simulation.bodies(0)) position.push_back(b.position);
    position.resize(is_first.size());
    return lacey_index(position, is_first, cube);
  };
  scene.measure = [index](sim::Simulation& simulation) -> std::vector<SceneNumber> {
    return {{"mixing_index", index(simulation)}};
  };
  scene.watch = [=](sim::Simulation& simulation, double time) -> std::vector<SceneNumber> {
    return {{"turns", time * turns_per_second}, {"mixing_index", index(simulation)}};
  };
  scene.watch_every = 1 / (kLooksPerTurn * turns_per_second);
  return scene;
}

}  // namespace gonogo::lab
