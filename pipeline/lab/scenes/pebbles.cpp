#include "pipeline/lab/scenes/pebbles.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/units.h"
#include "vehicle/model/engine_vehicle.h"
#include "vehicle/model/statics.h"

namespace gonogo::lab {
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
  for (const vehicle::Track& t : v.track) {
    const double thick = t.pad_below_pin + t.grouser_height;
    f.front = std::max(f.front, t.sprocket.centre.x + t.sprocket_radius + thick);
    f.rear = std::min(f.rear, t.idler_travel.x - vehicle::pin_circle(t, t.idler_radius) - thick);
  }
  for (const vehicle::RunningPart& p : vehicle::running_parts(v))
    f.half_width = std::max(f.half_width, std::fabs(p.centre.y) + v.track[0].shoe_width / 2);
  return f;
}

/// Distance from the tank's low x to the vehicle's origin.
double place_along(const PebblesSpec& spec, const sim::SceneWorld& tank, const Footprint& f) {
  const double length = tank.size.x, width = tank.size.y;
  const double way = spec.speed * spec.driven, long_enough = f.front - f.rear + way + 2 * kRoom,
               wide_enough = 2 * (f.half_width + kRoom);
  char text[300];
  std::snprintf(
      text, sizeof text,
      "pebbles: %d pebbles of %.3g m make a floor of %.2f x %.2f m, and the vehicle with its way of %.1f m takes "
      "%.2f x %.2f m; give more --spheres, a larger --diameter or fewer --seconds",
      spec.tank.of.count, spec.tank.of.diameter, length, width, way, long_enough, wide_enough);
  if (length < long_enough || width < wide_enough) throw InputError(text);
  return kRoom - f.rear;
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
struct Driven {
  vehicle::Vehicle v;
  vehicle::EngineVehicle e;
  sim::BodyIndex first = 0, end = 0;  // its bodies
  double start = 0;                   // of its chassis along x [m]
};

vehicle::DriverOrders orders_of(const PebblesSpec& spec) {
  vehicle::DriverOrders orders;
  orders.release = kStands;
  orders.throttle_ramp = kSpeedUp;
  orders.speed = spec.speed;
  return orders;
}

std::vector<Measured> look_at(const Driven& d, sim::Simulation& simulation) {
  Vec3d force;
  for (sim::BodyIndex b = d.first; b < d.end; ++b) force += simulation.contact_force(0, b);
  const sim::BodyState chassis = simulation.body(0, d.e.chassis);
  double turning = 0;
  for (const vehicle::EngineTrack& t : d.e.track) turning += simulation.body(0, t.sprocket).angular_velocity.y / 2;
  const double rolled = turning * vehicle::rolling_radius(d.v.track[0]), speed = chassis.velocity.x;
  return {{"way_m", chassis.position.x - d.start},
          {"speed_m_per_s", speed},
          {"slip", std::fabs(rolled) > 0.1 ? 1 - speed / rolled : 0},
          {"load_over_weight", force.z / (vehicle::weigh(d.v).total * kGravity)}};
}

/// Bodies, joints and drive of the vehicle on the pebbles.
std::shared_ptr<const Driven> add_tracked(sim::SceneWorld& world, const PebblesSpec& spec) {
  const auto d = std::make_shared<Driven>();
  d->v = vehicle::set_down(vehicle::read_vehicle(spec.vehicle));
  if (d->v.track.empty())
    throw InputError(spec.vehicle.string() + ": kind: the vehicle has no tracks; name a tracked one, such as m113");
  const Footprint f = footprint_of(d->v);
  Vec3d origin{world.origin.x + place_along(spec, world, f), world.origin.y + world.size.y / 2, 0};
  origin.z = height_under(world, f, origin, spec.tank.of.diameter) + vehicle::standing_height(d->v);
  d->first = sim::BodyIndex(world.body.size());
  d->e = vehicle::add_vehicle(world, d->v, origin, kTool);
  d->end = sim::BodyIndex(world.body.size());
  vehicle::add_drive(world, d->v, d->e, orders_of(spec));
  d->start = world.body[std::size_t(d->e.chassis)].position.x;
  return d;
}

}  // namespace

ManyScene pebbles_scene(const PebblesSpec& spec, const RunOn& on) {
  ManyScene scene;
  scene.name = "pebbles";
  scene.settings = many_step_settings(spec.tank.of, on.iterations, on.solver);
  scene.settings.step = Real(kStep);
  scene.duration = kStands + spec.driven;
  scene.world = tank_world(spec.tank, on);
  scene.world.size.z += kHeadroom;
  const Real rolling = Real(spec.rolling_friction);
  scene.world.set_law(0, 0, {Real(spec.tank.of.friction), rolling, 0});
  scene.world.set_law(0, kTool, {Real(spec.belt_friction), rolling, 0});
  const std::shared_ptr<const Driven> d = add_tracked(scene.world, spec);
  scene.measure = [d](sim::Simulation& simulation) { return look_at(*d, simulation); };
  scene.watch_every = 0.1;
  scene.watch = over_time(scene.measure);
  return scene;
}

}  // namespace gonogo::lab
