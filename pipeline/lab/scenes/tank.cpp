#include "pipeline/lab/scenes/tank.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "base/units.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/driving.h"

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

/// Volume of a sphere about the origin, between two heights.
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

CollideBenchResult bench_collide(const CollideBench& request) {
  sim::require_backend(request.on.backend);
  const double start = seconds();
  const auto simulation = sim::make_simulation(request.on.backend, {tank_world(request.tank, request.on)},
                                               many_step_settings(request.tank.of, 1), request.on.threads);
  sim::StepByStage& stages = sim::by_stage(*simulation);
  CollideBenchResult r;
  r.contacts = stages.timed_search().contact_count;
  r.build_seconds = seconds() - start;
  std::vector<sim::StageTimes> samples;
  std::vector<double> whole;
  for (int k = 0; k < request.repeats; ++k) {
    samples.push_back(stages.timed_search().times);
    whole.push_back(samples.back().of(sim::Stage::bins) + samples.back().of(sim::Stage::contacts));
  }
  r.bodies = request.tank.of.count + 1;
  r.stages = median_times(samples);
  r.ms_per_search = median(whole) * 1e3;
  r.ns_per_contact = median(whole) * 1e9 / double(r.contacts);
  return r;
}

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
  scene.measure = [=, world = scene.world](sim::Simulation& simulation) -> std::vector<SceneNumber> {
    const auto bodies = simulation.bodies(0);
    const double level = surface_of(bodies, spec.tank, world, radius);
    return {{"sunk_share", sunk_share(level - bodies[0].position.z, radius)},
            {"relative_density", spec.relative_density},
            {"speed_m_per_s", double(length(bodies[0].velocity))}};
  };
  return scene;
}

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
  scene.measure = [=](sim::Simulation& simulation) -> std::vector<SceneNumber> {
    const double depth = surface - (simulation.body(0, 0).position.z - radius);
    return {{"depth_m", depth}, {"total_fall_m", spec.drop_height + depth}};
  };
  return scene;
}

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
  scene.measure = [=, world = scene.world](sim::Simulation& simulation) -> std::vector<SceneNumber> {
    const auto bodies = simulation.bodies(0);
    return {{"height_over_depth_start", before},
            {"height_over_depth_end", bodies[0].position.z / surface_of(bodies, spec.tank, world, radius)}};
  };
  return scene;
}

namespace {

constexpr int kTool = 1;         // material
constexpr double kStands = 1;    // before the brakes are released [s]
constexpr double kSpeedUp = 1;   // time in which the commanded speed rises [s]
constexpr double kStep = 1e-3;   // of the checks of tracks on hard ground [s]
constexpr double kHeadroom = 4;  // over the surface [m]
constexpr double kRoom = 0.3;    // beside and behind the vehicle [m]

/// Belts from above, about the vehicle's origin [m].
struct Footprint {
  double rear = 1e9, front = -1e9, half_width = 0;
};

Footprint footprint_of(const vehicle::Vehicle& v) {
  Footprint f;
  const vehicle::Track& t = *v.track;
  const double thick = t.pad_below_pin + t.grouser_height;
  f.front = t.sprocket.centre.x + t.sprocket_radius + thick;
  f.rear = t.idler_travel.x - vehicle::pin_circle(t, t.idler_radius) - thick;
  for (const vehicle::RunningPart& p : vehicle::running_parts(v))
    f.half_width = std::max(f.half_width, std::fabs(p.centre.y) + t.shoe_width / 2);
  return f;
}

/// Distance from the tank's low x to the vehicle's origin.
double place_along(const PebblesSpec& spec, const sim::SceneWorld& tank, const Footprint& f) {
  const double length = tank.size.x, width = tank.size.y;
  const double way = spec.speed * spec.driven, long_enough = f.front - f.rear + way + 2 * kRoom,
               wide_enough = 2 * (f.half_width + kRoom);
  if (length >= long_enough && width >= wide_enough) return kRoom - f.rear;
  throw InputError(
      line("pebbles: %d pebbles of %.3g m make a floor of %.2f x %.2f m, and the vehicle with its way of %.1f m takes "
           "%.2f x %.2f m; give more --spheres, a larger --diameter or fewer --seconds",
           spec.tank.of.count, spec.tank.of.diameter, length, width, way, long_enough, wide_enough));
}

/// Highest point of the pebbles that lie under the belts, or beside them by less than a pebble [m].
double height_under(const sim::SceneWorld& tank, const Footprint& f, const Vec3d& origin, double diameter) {
  double top = 0;
  for (const sim::Shape& s : tank.shape) {
    if (s.type != sim::ShapeType::sphere) continue;
    const Vec3d p = tank.body[s.body].position - origin;
    if (p.x > f.rear - diameter && p.x < f.front + diameter && std::fabs(p.y) < f.half_width + diameter)
      top = std::max(top, p.z + double(s.size.x));
  }
  return top;
}

/// What a look at the vehicle needs; the file's contents must outlive the engine's.
struct TrackedDrive {
  vehicle::Vehicle v;
  vehicle::EngineVehicle e;
  sim::BodyIndex first = 0, end = 0;  // its bodies
  double start = 0;                   // of its chassis along x [m]
};

vehicle::DriverOrders orders_of(const PebblesSpec& spec) {
  return {.release = kStands, .throttle_ramp = kSpeedUp, .speed = spec.speed};
}

std::vector<SceneNumber> look_at(const TrackedDrive& d, sim::Simulation& simulation) {
  Vec3d force;
  for (sim::BodyIndex b = d.first; b < d.end; ++b) force += simulation.contact_force(0, b);
  const sim::BodyState chassis = simulation.body(0, d.e.chassis);
  double turning = 0;
  for (const vehicle::EngineTrack& t : d.e.track) turning += simulation.body(0, t.sprocket).angular_velocity.y / 2;
  const double rolled = turning * vehicle::rolling_radius(*d.v.track), speed = chassis.velocity.x;
  return {{"way_m", chassis.position.x - d.start},
          {"speed_m_per_s", speed},
          {"slip", std::fabs(rolled) > 0.1 ? 1 - speed / rolled : 0},
          {"load_over_weight", force.z / (vehicle::weigh(d.v).total * kGravity)}};
}

/// Bodies, joints and drive of the vehicle on the pebbles.
std::shared_ptr<const TrackedDrive> add_tracked(sim::SceneWorld& world, const PebblesSpec& spec) {
  const auto d = std::make_shared<TrackedDrive>();
  d->v = vehicle::set_down(vehicle::read_vehicle(spec.vehicle));
  if (!d->v.track)
    throw InputError(spec.vehicle.string() + ": kind: the vehicle has no tracks; name a tracked one, such as m113");
  const Footprint f = footprint_of(d->v);
  Vec3d origin{world.origin.x + place_along(spec, world, f), world.origin.y + world.size.y / 2, 0};
  origin.z = height_under(world, f, origin, spec.tank.of.diameter) + vehicle::standing_height(d->v);
  d->first = sim::BodyIndex(world.body.size());
  d->e = vehicle::add_vehicle(world, d->v, origin, kTool);
  d->end = sim::BodyIndex(world.body.size());
  vehicle::add_driveline(world, d->v, d->e, orders_of(spec));
  d->start = world.body[std::size_t(d->e.chassis)].position.x;
  return d;
}

}  // namespace

ManyScene pebbles_scene(const PebblesSpec& spec, const RunOn& on) {
  ManyScene scene{.name = "pebbles", .settings = many_step_settings(spec.tank.of, on.iterations, on.solver)};
  scene.settings.step = Real(kStep);
  scene.duration = kStands + spec.driven;
  scene.world = tank_world(spec.tank, on);
  scene.world.size.z += kHeadroom;
  const Real rolling = Real(spec.rolling_friction);
  scene.world.set_law(0, 0, {Real(spec.tank.of.friction), rolling, 0});
  scene.world.set_law(0, kTool, {Real(spec.belt_friction), rolling, 0});
  const std::shared_ptr<const TrackedDrive> d = add_tracked(scene.world, spec);
  scene.measure = [d](sim::Simulation& simulation) { return look_at(*d, simulation); };
  scene.watch_every = 0.1;
  scene.watch = over_time(scene.measure);
  return scene;
}

}  // namespace gonogo::lab
