#include "vehicle/world/engine_track.h"

#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "sim/scene/scene.h"

namespace gonogo::vehicle {
namespace {

/// Shapes of plates, horns and sprockets, which never touch each other.
constexpr int kPlates = 1;
/// Room between a tooth and the bosses beside it, and how far it reaches over the chord between their pins [m].
constexpr double kToothRoom = 0.003, kToothReach = 0.012;
/// Plates end this far before the bosses of their neighbours, whatever the angle between them [m].
constexpr double kPlateRoom = 0.005;
/// How much stiffer than its spring the stops at both ends of a tensioner's travel are.
constexpr double kStop = 10;

Quat about_y(double angle) { return {Real(std::cos(angle / 2)), 0, Real(std::sin(angle / 2)), 0}; }

Quat backwards(const Quat& q) { return {q.w, -q.x, -q.y, -q.z}; }

sim::Shape shape_on(sim::BodyIndex body, sim::ShapeType type, const Vec3& size, int material) {
  sim::Shape s;
  s.type = type;
  s.body = body;
  s.size = size;
  s.material = material;
  return s;
}

void add_sprocket_shape(sim::SceneWorld& world, const Track& t, const TrackLoop& loop, sim::BodyIndex body,
                        int material) {
  const Belt& b = *t.belt;
  const int teeth = sprocket_teeth(t);
  const double hub = t.sprocket_radius - b.pin_radius, chord = t.sprocket_radius * std::cos(kPi / teeth);
  sim::Shape s =
      shape_on(body, sim::ShapeType::wheel,
               {Real(hub), Real(0.5 * b.disc_distance + b.pin_radius), Real(chord + kToothReach - hub)}, material);
  s.group = kPlates;
  s.lug_count = teeth;
  s.lug_thickness = Real(t.shoe_pitch - 2 * b.pin_radius - 2 * kToothRoom);
  s.turn_B = backwards(world.body[std::size_t(body)].orientation) * about_y(-loop.tooth_angle);
  world.add_shape(s);
}

/// Plate, grouser, horn and the boss around the pin behind, in the shoe's axes: x along the belt, z inwards.
void add_shoe_shapes(sim::SceneWorld& world, const Track& t, sim::BodyIndex body, int material) {
  const Belt& b = *t.belt;
  const double half = 0.5 * t.shoe_pitch - b.pin_radius - kPlateRoom;
  const auto add_box = [&](const Vec3d& middle, const Vec3d& size) {
    sim::Shape s = shape_on(body, sim::ShapeType::box, static_cast<Vec3>(0.5 * size), material);
    s.offset_B = static_cast<Vec3>(middle);
    s.group = kPlates;
    world.add_shape(s);
  };
  add_box({0, 0, 0.5 * (t.pad_above_pin - t.pad_below_pin)},
          {2 * half, t.shoe_width, t.pad_above_pin + t.pad_below_pin});
  add_box({0, 0, t.pad_above_pin + 0.5 * b.guide.z}, b.guide);
  if (t.grouser_height > 0)
    add_box({0, 0, -t.pad_below_pin - 0.5 * t.grouser_height},
            {std::min(2 * half, b.grouser_thickness), t.shoe_width, t.grouser_height});
  for (const double side : {-1.0, 1.0}) {
    sim::Shape boss = shape_on(body, sim::ShapeType::sphere, {Real(b.pin_radius), 0, 0}, material);
    boss.offset_B = {Real(-0.5 * t.shoe_pitch), Real(0.5 * side * b.disc_distance), 0};
    world.add_shape(boss);
  }
}

void add_shoes(sim::SceneWorld& world, const Track& t, const TrackLoop& loop, const Vec3d& origin, int material,
               EngineTrack& track) {
  const std::size_t count = loop.pin.size();
  const Vec3d& inertia = t.belt->shoe_inertia;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3d from = loop.pin[k], way = loop.pin[(k + 1) % count] - from;
    sim::BodyState state;
    state.position = origin + from + 0.5 * way;
    state.orientation = about_y(std::atan2(-way.z, way.x));
    track.shoe.push_back(world.add_body(state, sim::solid(Real(t.shoe_mass), static_cast<Vec3>(inertia))));
    add_shoe_shapes(world, t, track.shoe.back(), material);
  }
  // All pins are parallel. The last one closes a loop that the others leave no freedom but in its plane.
  for (std::size_t k = 0; k < count; ++k) {
    const sim::BodyIndex shoe = track.shoe[k], before = track.shoe[(k + count - 1) % count];
    const Vec3d at = origin + loop.pin[k], axis{0, 1, 0};
    track.pin.push_back(Index(world.joint.size()));
    world.joint.push_back(k > 0 ? sim::revolute(world, shoe, before, at, axis)
                                : sim::in_line(world, shoe, before, at, axis));
  }
}

/// Pushes along the travel with the file's force where the loop closes; stops at both ends of the travel.
void add_tensioner(sim::SceneWorld& world, const Track& t, double tension, const sim::Joint& slide,
                   EngineTrack& track) {
  const Belt& b = *t.belt;
  const double travel = length(t.idler_travel - t.idler.centre), k = b.tensioner_stiffness;
  const double free = b.tensioner_force / k, back = -tension * travel, out = (1 - tension) * travel;
  const auto pull = [&](double at) { return k * (at - free); };
  sim::SpringDamper spring = sim::spring_along(slide, 0, 0, b.tensioner_damping);
  spring.table = sim::force_table({{back - 0.01, pull(back) - kStop * k * 0.01},
                                   {back, pull(back)},
                                   {out, pull(out)},
                                   {out + 0.01, pull(out) + kStop * k * 0.01}});
  track.tensioner = Index(world.spring.size());
  world.spring.push_back(spring);
}

std::size_t link_to(const Assembly& a, int child) {
  for (std::size_t l = 0; l < a.link.size(); ++l)
    if (a.link[l].child == child && !a.link[l].loop) return l;
  throw InputError("nothing holds " + a.body[std::size_t(child)].name);
}

}  // namespace

void require_belt(const Vehicle& v) {
  const std::string where = "vehicle " + v.name + ": ";
  if (!v.track->belt)
    throw InputError(where +
                     "its file has no track.belt, without which its tracks cannot be simulated; add the "
                     "section (docs/vehicles.md)");
  check_sprocket(*v.track, where);
  for (const Station& s : stations(v))
    if (s.suspension->type != SuspensionType::trailing_arm)
      throw InputError(where + "road wheels of a track in a trial hang on trailing arms; " + s.name + " does not");
}

void add_double_wheel(sim::SceneWorld& world, const Vehicle& v, sim::BodyIndex body, double radius, double width,
                      int material) {
  const double gap = v.track->belt->wheel_gap, disc = 0.5 * (width - gap);
  const Quat back = backwards(world.body[std::size_t(body)].orientation);
  for (const double side : {-1.0, 1.0}) {
    sim::Shape s = shape_on(body, sim::ShapeType::cylinder, {Real(radius), Real(0.5 * disc), 0}, material);
    s.offset_B = rotate(back, {0, Real(0.5 * side * (gap + disc)), 0});
    s.turn_B = back;
    world.add_shape(s);
  }
}

void add_torsion_spring(sim::SceneWorld& world, const Station& station, const Assembly& assembly, int wheel,
                        const EngineBodies& bodies) {
  const int arm = assembly.link[link_to(assembly, wheel)].parent;
  const std::size_t pivot = link_to(assembly, arm);
  const TorsionSpring& t = station.suspension->torsion;
  // A wheel behind its pivot goes up when its arm turns about y.
  const double up = station.centre.x < assembly.link[pivot].point.x ? 1 : -1;
  world.spring.push_back(sim::spring_about(world.joint[std::size_t(bodies.joint[pivot])], -up * t.preload / t.stiffness,
                                           t.stiffness, t.damping));
}

void add_sprockets_and_idlers(sim::SceneWorld& world, const Vehicle& v, const TrackLoop (&loops)[2],
                              const Assembly& assembly, const EngineBodies& bodies, int material) {
  const Track& t = *v.track;
  for (std::size_t k = 0; k < 2; ++k) {
    const TrackBodies& own = assembly.track[k];
    add_sprocket_shape(world, t, loops[k], bodies.body[std::size_t(own.sprocket)], material);
    add_double_wheel(world, v, bodies.body[std::size_t(own.idler)], t.idler_radius, t.belt->idler_width, material);
  }
}

EngineTrack add_belt(sim::SceneWorld& world, const Vehicle& v, double side, const TrackLoop& loop,
                     const Assembly& assembly, const EngineBodies& bodies, const Vec3d& origin, int material) {
  const Track& t = *v.track;
  const TrackBodies& own = assembly.track[side > 0 ? 0 : 1];
  EngineTrack track;
  track.sprocket = bodies.body[std::size_t(own.sprocket)];
  track.idler = bodies.body[std::size_t(own.idler)];
  track.carrier = bodies.body[std::size_t(own.carrier)];
  track.brake_torque = t.brake_torque;
  add_shoes(world, t, loop, origin + Vec3d{0, side * t.offset, 0}, material, track);
  const auto joint_to = [&](int body) -> const sim::Joint& {
    return world.joint[std::size_t(bodies.joint[link_to(assembly, body)])];
  };
  add_tensioner(world, t, loop.tension, joint_to(own.carrier), track);
  const sim::Joint axle = joint_to(own.sprocket);
  for (Index* motor : {&track.drive_motor, &track.brake_motor}) *motor = add_motor(world, sim::speed_motor(axle, 0, 0));
  return track;
}

}  // namespace gonogo::vehicle
