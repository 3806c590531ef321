#include "pipeline/bench/tank_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/progress.h"
#include "base/random.h"

namespace gonogo::pipeline {
namespace {

struct Sphere {
  Vec3d centre;
  double radius;
};

/// A floor of `copies` x `copies` blocks, each of `side` x `side` columns of `layers` spheres.
struct Blocks {
  int side = 0, copies = 1, layers = 1;
};

/// A block is so many columns wide where the tank has that many: its periodic images do not notice each other, and
/// it settles in seconds.
constexpr int kLeastSide = 10, kMostSide = 14;

Blocks choose_blocks(const TankSpec& spec) {
  Blocks b;
  b.layers = std::min(spec.layers, std::max(2, int(std::lround(std::cbrt(double(spec.spheres))))));
  const int columns = int(std::ceil(std::sqrt(std::ceil(double(spec.spheres) / b.layers))));
  b.side = std::max(columns, 4);
  if (columns <= kMostSide) return b;
  int least = 0;
  for (int side = kLeastSide; side <= kMostSide; ++side) {
    const int copies = (columns + side - 1) / side;
    if (least != 0 && copies * side >= least) continue;
    least = copies * side;
    b.side = side, b.copies = copies;
  }
  return b;
}

double largest_diameter(const TankSpec& spec) { return spec.diameter * (1 + spec.size_spread); }

/// Columns are so far apart that no two spheres overlap, wherever their draws put them.
double pitch(const TankSpec& spec) { return 1.01 * largest_diameter(spec); }

/// Spheres of a cubic lattice, each a little aside so that columns buckle.
std::vector<Sphere> loose_block(const TankSpec& spec, const Blocks& blocks) {
  std::vector<Sphere> spheres;
  std::uint64_t draw = 0;
  const auto between = [&](double low, double high) { return low + (high - low) * random_unit(spec.seed, 0, draw++); };
  const double aside = 0.005 * largest_diameter(spec);
  for (int z = 0; z < blocks.layers; ++z)
    for (int y = 0; y < blocks.side; ++y)
      for (int x = 0; x < blocks.side; ++x) {
        const double dx = between(-aside, aside), dy = between(-aside, aside);
        const Vec3d at{(x + 0.5) * pitch(spec) + dx, (y + 0.5) * pitch(spec) + dy, (z + 0.5) * pitch(spec)};
        spheres.push_back({at, spec.diameter / 2 * (1 + spec.size_spread * between(-1, 1))});
      }
  return spheres;
}

void add_plane(sim::SceneWorld& world, sim::BodyIndex body, const Vec3d& at, const Quat& turn) {
  sim::Shape plane;
  plane.type = sim::ShapeType::plane;
  plane.body = body;
  plane.offset_B = static_cast<Vec3>(at);
  plane.turn_B = turn;
  world.add_shape(plane);
}

/// Turns the z axis, along which a plane looks, into x, -x, y or -y.
Quat towards(int axis, double sign) {
  const Real c = Real(std::sqrt(0.5)), s = Real(sign * std::sqrt(0.5));
  return axis == 0 ? Quat{c, 0, s, 0} : Quat{c, -s, 0, 0};
}

/// Without walls: periodic sides of this length.
sim::SceneWorld world_of(const TankSpec& spec, const std::vector<Sphere>& spheres, double side, double height) {
  sim::SceneWorld world;
  world.origin = {0, 0, -2 * spec.diameter};
  world.size = {side, side, height + 4 * spec.diameter};
  world.set_law(0, 0, {Real(spec.friction), 0, 0});
  for (const Sphere& s : spheres) world.add_sphere(s.centre, Real(s.radius), Real(spec.density), 0);
  add_plane(world, world.add_body({}, sim::fixed_body()), {}, {});
  return world;
}

double height_of(const std::vector<Sphere>& spheres) {
  double height = 0;
  for (const Sphere& s : spheres) height = std::max(height, s.centre.z + s.radius);
  return height;
}

/// Less than the spheres have later: they pack more densely.
constexpr double kSettlingFriction = 0.1;

/// Falls and comes to rest: twice as long as the topmost sphere needs to fall through a third of the height.
std::vector<Sphere> settled(const TankSpec& spec, const Blocks& blocks, sim::Backend backend, int threads) {
  std::vector<Sphere> spheres = loose_block(spec, blocks);
  const double side = blocks.side * pitch(spec), height = height_of(spheres);
  sim::SceneWorld world = world_of(spec, spheres, side, height);
  world.periodic_x = world.periodic_y = true;
  world.set_law(0, 0, {Real(kSettlingFriction), 0, 0});
  const sim::StepSettings settings = tank_step_settings(spec, 20);
  const auto simulation = sim::make_simulation(backend, {world}, settings, threads);
  const double fall = std::sqrt(2 * (height / 3) / 9.81);
  simulation->advance(Index(std::ceil(2 * fall / settings.step)));
  if (const sim::StepReport report = simulation->report(0); report.flags != 0)
    throw DeviceError("tank: settling failed: " + sim::description(report.fault, settings.step));
  const auto bodies = simulation->bodies(0);
  for (std::size_t b = 0; b < spheres.size(); ++b) spheres[b].centre = bodies[b].position;
  return spheres;
}

std::vector<Sphere> laid_out(const std::vector<Sphere>& block, const Blocks& blocks, double side) {
  std::vector<Sphere> spheres;
  spheres.reserve(block.size() * std::size_t(blocks.copies) * std::size_t(blocks.copies));
  for (int y = 0; y < blocks.copies; ++y)
    for (int x = 0; x < blocks.copies; ++x)
      for (const Sphere& s : block) spheres.push_back({s.centre + Vec3d{x * side, y * side, 0}, s.radius});
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

}  // namespace

sim::StepSettings tank_step_settings(const TankSpec& spec, int iterations) {
  sim::StepSettings s;
  s.step = Real(2e-3);
  s.iterations = iterations;
  s.envelope = Real(0.06 * spec.diameter);  // about 3.6 contacts a sphere, as in the published tank
  s.recovery_speed = Real(std::sqrt(9.81 * spec.diameter) / 10);
  return s;
}

sim::SceneWorld tank_world(const TankSpec& spec, sim::Backend backend, int threads) {
  const Blocks blocks = choose_blocks(spec);
  const double block_side = blocks.side * pitch(spec), side = blocks.copies * block_side;
  log_line("bench", "settling " + std::to_string(blocks.side * blocks.side * blocks.layers) + " spheres, laid out " +
                        std::to_string(blocks.copies * blocks.copies) + " times");
  std::vector<Sphere> spheres = laid_out(settled(spec, blocks, backend, threads), blocks, block_side);
  keep_lowest(spheres, std::size_t(spec.spheres));
  sim::SceneWorld world = world_of(spec, spheres, side, height_of(spheres));
  const double room = largest_diameter(spec) / 2;  // centres lie anywhere between the periodic sides
  const sim::BodyIndex tank = sim::BodyIndex(world.body.size()) - 1;
  add_plane(world, tank, {-room, 0, 0}, towards(0, 1));
  add_plane(world, tank, {side + room, 0, 0}, towards(0, -1));
  add_plane(world, tank, {0, -room, 0}, towards(1, 1));
  add_plane(world, tank, {0, side + room, 0}, towards(1, -1));
  world.origin = {-2 * room, -2 * room, world.origin.z};
  world.size.x = world.size.y = side + 4 * room;
  return world;
}

}  // namespace gonogo::pipeline
