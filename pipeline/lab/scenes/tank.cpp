#include "pipeline/lab/scenes/tank.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/progress.h"
#include "base/units.h"

namespace gonogo::lab {
namespace {

/// A floor of `along` x `across` tiling, each of `side` x `side` columns of `layers` spheres.
struct Tiling {
  int side = 0, along = 1, across = 1, layers = 1;
  std::int64_t columns() const { return std::int64_t(side) * side * along * across; }
};

/// A tile is so many columns wide where the tank has that many: its periodic images do not notice each other, and
/// it settles in seconds.
constexpr int kMinSide = 10, kMaxSide = 14;

Tiling choose_tiling(const TankSpec& spec) {
  Tiling b;
  b.layers = std::min(spec.layers, std::max(2, int(std::lround(std::cbrt(double(spec.of.count))))));
  const double columns = std::ceil(double(spec.of.count) / b.layers);
  const int across = int(std::ceil(std::sqrt(columns / spec.length_over_width))),
            along = int(std::ceil(across * spec.length_over_width));
  const auto lay = [&](int side) {
    return Tiling{side, (along + side - 1) / side, (across + side - 1) / side, b.layers};
  };
  if (across <= kMaxSide) return lay(std::max(across, 4));
  for (int side = kMinSide; side <= kMaxSide; ++side)
    if (const Tiling other = lay(side); b.side == 0 || other.columns() < b.columns()) b = other;
  return b;
}

std::vector<Sphere> loose_tile(const TankSpec& spec, const Tiling& tiling) {
  return loose_lattice(
      spec.of, {}, tiling.side, tiling.side, tiling.layers, [](const Vec3d&) { return true; },
      std::size_t(tiling.side) * std::size_t(tiling.side) * std::size_t(tiling.layers));
}

/// Without walls.
sim::SceneWorld world_of(const TankSpec& spec, const std::vector<Sphere>& spheres, double length, double width,
                         double height) {
  sim::SceneWorld world;
  world.origin = {0, 0, -2 * spec.of.diameter};
  world.size = {length, width, height + 4 * spec.of.diameter};
  world.set_law(0, 0, {Real(spec.of.friction), 0, 0});
  for (const Sphere& s : spheres) world.add_sphere(s.centre, Real(s.radius), Real(spec.of.density), 0);
  add_plane(world, world.add_body({}, sim::fixed_body()), {}, {});
  return world;
}

/// Less than the spheres have later: they pack more densely.
constexpr double kSettlingFriction = 0.1;

/// Falls and comes to rest: twice as long as the topmost sphere needs to fall through a third of the height.
std::vector<Sphere> settled(const TankSpec& spec, const Tiling& tiling, const RunOn& on) {
  std::vector<Sphere> spheres = loose_tile(spec, tiling);
  const double side = tiling.side * spec.of.pitch(), height = height_of(spheres);
  sim::SceneWorld world = world_of(spec, spheres, side, side, height);
  world.periodic_x = world.periodic_y = true;
  world.set_law(0, 0, {Real(kSettlingFriction), 0, 0});
  const sim::StepSettings settings = many_step_settings(spec.of, 20);
  const auto simulation = sim::make_simulation(on.backend, {world}, settings, on.threads);
  simulation->advance(Index(std::ceil(2 * fall_time(height / 3) / settings.step)));
  if (const sim::StepReport report = simulation->report(0); report.flags != 0)
    throw DeviceError("tank: settling failed: " + sim::description(report.fault, settings.step));
  const auto bodies = simulation->bodies(0);
  for (std::size_t b = 0; b < spheres.size(); ++b) spheres[b].centre = bodies[b].position;
  return spheres;
}

std::vector<Sphere> laid_out(const std::vector<Sphere>& tile, const Tiling& tiling, double side) {
  std::vector<Sphere> spheres;
  spheres.reserve(tile.size() * std::size_t(tiling.along) * std::size_t(tiling.across));
  for (int y = 0; y < tiling.across; ++y)
    for (int x = 0; x < tiling.along; ++x)
      for (const Sphere& s : tile) spheres.push_back({s.centre + Vec3d{x * side, y * side, 0}, s.radius});
  return spheres;
}

/// The lowest ones, in the order in which they were.
void keep_lowest(std::vector<Sphere>& spheres, std::size_t count) {
  std::vector<std::size_t> order(spheres.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  const auto last = order.begin() + std::ptrdiff_t(count);
  std::nth_element(order.begin(), last, order.end(), [&](std::size_t a, std::size_t b) {
    return spheres[a].centre.z != spheres[b].centre.z ? spheres[a].centre.z < spheres[b].centre.z : a < b;
  });
  std::sort(order.begin(), last);
  for (std::size_t k = 0; k < count; ++k) spheres[k] = spheres[order[k]];
  spheres.resize(count);
}

/// Of a sphere about the origin, between two heights.
double volume_between(double radius, double low, double high) {
  const double a = std::clamp(low, -radius, radius), b = std::clamp(high, -radius, radius);
  return kPi * (radius * radius * (b - a) - (b * b * b - a * a * a) / 3);
}

}  // namespace

sim::SceneWorld tank_world(const TankSpec& spec, const RunOn& on) {
  const Tiling tiling = choose_tiling(spec);
  const double side = tiling.side * spec.of.pitch(), length = tiling.along * side, width = tiling.across * side;
  log_line("bench", "settling " + std::to_string(tiling.side * tiling.side * tiling.layers) + " spheres, laid out " +
                        std::to_string(tiling.along * tiling.across) + " times");
  std::vector<Sphere> spheres = laid_out(settled(spec, tiling, on), tiling, side);
  keep_lowest(spheres, std::size_t(spec.of.count));
  sim::SceneWorld world = world_of(spec, spheres, length, width, height_of(spheres));
  const double room = spec.of.largest_diameter() / 2;  // centres lie anywhere between the periodic sides
  const sim::BodyIndex tank = sim::BodyIndex(world.body.size()) - 1;
  add_plane(world, tank, {-room, 0, 0}, towards(0, 1));
  add_plane(world, tank, {length + room, 0, 0}, towards(0, -1));
  add_plane(world, tank, {0, -room, 0}, towards(1, 1));
  add_plane(world, tank, {0, width + room, 0}, towards(1, -1));
  world.origin = {-2 * room, -2 * room, world.origin.z};
  world.size.x = length + 4 * room;
  world.size.y = width + 4 * room;
  return world;
}

double solid_fraction(const TankSpec& spec, const sim::SceneWorld& world) {
  const double d = spec.of.diameter;
  double surface = 0;
  Vec3d low{1e30, 1e30, 2 * d}, high{-1e30, -1e30, 0};
  for (Index b = 0; b < spec.of.count; ++b) {
    const Vec3d& p = world.body[b].position;
    low.x = std::min(low.x, p.x);
    low.y = std::min(low.y, p.y);
    high.x = std::max(high.x, p.x);
    high.y = std::max(high.y, p.y);
    surface = std::max(surface, p.z);
  }
  const Vec3d aside{2 * d, 2 * d, 0};
  low += aside;
  high -= aside;
  high.z = surface - 2 * d;
  // A sphere counts with the share of its height that lies between the two levels, and whole across them.
  double solid = 0;
  for (const sim::Shape& s : world.shape) {
    if (s.type != sim::ShapeType::sphere) continue;
    const Vec3d& p = world.body[s.body].position;
    if (p.x < low.x || p.x >= high.x || p.y < low.y || p.y >= high.y) continue;
    solid += volume_between(double(s.size.x), low.z - p.z, high.z - p.z);
  }
  return solid / ((high.x - low.x) * (high.y - low.y) * (high.z - low.z));
}

ManyScene shaken_tank(const TankSpec& spec, const RunOn& on) {
  ManyScene scene;
  scene.name = "tank";
  scene.world = tank_world(spec, on);
  scene.settings = many_step_settings(spec.of, on.iterations, on.solver);
  scene.duration = spec.seconds;
  scene.drive = [](sim::Simulation& simulation, double time) {
    const double acceleration = 0.5 * kGravity * std::sin(2 * kPi * 2 * time);
    simulation.set_gravity(0, {Real(-acceleration), 0, Real(-kGravity)});
  };
  return scene;
}

}  // namespace gonogo::lab
