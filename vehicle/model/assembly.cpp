#include "vehicle/model/assembly.h"

#include <algorithm>
#include <cmath>

namespace gonogo::vehicle {
namespace {

/// Mirror image of a left-hand vector: across the middle plane for the right side.
Vec3d mirrored(const Vec3d& v, double side) { return {v.x, side < 0 ? -v.y : v.y, v.z}; }

Part mirrored(Part p, double side) {
  p.centre = mirrored(p.centre, side);
  if (side < 0) {
    p.products.x = -p.products.x;
    p.products.z = -p.products.z;
  }
  return p;
}

Part point_mass(const std::string& name, double mass, const Vec3d& at) {
  return {.name = name, .mass = mass, .centre = at};
}

/// Adds to a part's inertia that of its mass at an offset from a new reference point.
void shift(Part& p, const Vec3d& offset) {
  const Vec3d& d = offset;
  p.moments += p.mass * Vec3d{d.y * d.y + d.z * d.z, d.x * d.x + d.z * d.z, d.x * d.x + d.y * d.y};
  p.products -= p.mass * Vec3d{d.x * d.y, d.x * d.z, d.y * d.z};
}

struct Corner {
  const Station& station;
  Assembly& assembly;

  Vec3d at(const std::string& point) const {
    return station.mount + mirrored(station.suspension->point.at(point), station.side);
  }
  int add_part(const std::string& name) const {
    Part p = mirrored(station.suspension->part.at(name), station.side);
    p.centre += station.mount;
    p.name = station.name + " " + name;
    assembly.body.push_back(p);
    return int(assembly.body.size()) - 1;
  }
  int add_wheel() const {
    Part p = station.wheel->part;
    p.name = station.name + " wheel";
    p.centre = station.centre;
    assembly.body.push_back(p);
    assembly.wheel.push_back(int(assembly.body.size()) - 1);
    return assembly.wheel.back();
  }
  void add_axle(int hub) const {
    Link axle{.parent = hub, .child = add_wheel(), .point = station.centre, .axis = {0, 1, 0}, .wheel = true};
    assembly.link.push_back(axle);
  }
};

Vec3d direction(const Vec3d& from, const Vec3d& to) { return (to - from) * (1 / length(to - from)); }

void add_wishbones(const Corner& c) {
  Assembly& a = c.assembly;
  const int upper = c.add_part("upper_arm"), lower = c.add_part("lower_arm"), upright = c.add_part("upright");
  const double half_rod = 0.5 * c.station.suspension->tie_rod_mass;
  const Vec3d inner = c.at("tie_rod_chassis"), outer = c.at("tie_rod_upright");
  a.body[upright] = joined(a.body[upright], point_mass("", half_rod, outer));
  a.body[0] = joined(a.body[0], point_mass("", half_rod, inner));
  for (const auto& [arm, name] : {std::pair{upper, std::string("upper")}, std::pair{lower, std::string("lower")}})
    a.link.push_back(
        {.child = arm, .point = c.at(name + "_front"), .axis = direction(c.at(name + "_rear"), c.at(name + "_front"))});
  a.link.push_back({.type = LinkType::spherical, .parent = lower, .child = upright, .point = c.at("lower_ball")});
  a.link.push_back(
      {.type = LinkType::spherical, .parent = upper, .child = upright, .point = c.at("upper_ball"), .loop = true});
  a.link.push_back({.type = LinkType::distance, .child = upright, .point = outer, .parent_point = inner, .loop = true});
  c.add_axle(upright);
  const Suspension& s = *c.station.suspension;
  const auto arm_of = [&](const std::string& point) {
    // A strut stands on the lower arm, or on the upright when it is mounted beyond the arm's ball joint.
    return std::fabs(c.at(point).y) > std::fabs(c.at("lower_ball").y) - 1e-9 ? upright : lower;
  };
  a.strut.push_back({.child = arm_of("spring_arm"),
                     .parent_point = c.at("spring_chassis"),
                     .child_point = c.at("spring_arm"),
                     .spring = &s.spring});
  a.strut.push_back({.child = arm_of("damper_arm"),
                     .parent_point = c.at("damper_chassis"),
                     .child_point = c.at("damper_arm"),
                     .damper = &s.damper});
}

void add_trailing_arm(const Corner& c) {
  Assembly& a = c.assembly;
  const int arm = c.add_part("arm");
  a.link.push_back({.child = arm, .point = c.at("pivot"), .axis = {0, 1, 0}});
  c.add_axle(arm);
  if (!c.station.suspension->damper.force.empty())
    a.strut.push_back({.child = arm,
                       .parent_point = c.at("damper_chassis"),
                       .child_point = c.at("damper_arm"),
                       .damper = &c.station.suspension->damper});
}

void add_corner(const Corner& c) {
  switch (c.station.suspension->type) {
    case SuspensionType::double_wishbone:
      return add_wishbones(c);
    case SuspensionType::trailing_arm:
      return add_trailing_arm(c);
    case SuspensionType::rigid:
      return c.add_axle(0);
    case SuspensionType::guided:
      c.add_wheel();  // no joint holds it: see add_vehicle()
  }
}

std::string of_side(double side, const std::string& name) { return (side > 0 ? "left " : "right ") + name; }

/// A part of a track's side that turns about its centre; returns its body.
int add_turning(Assembly& a, Part p, int parent, double side) {
  p.name = of_side(side, p.name);
  a.body.push_back(p);
  const int body = int(a.body.size()) - 1;
  a.link.push_back({.parent = parent, .child = body, .point = p.centre, .axis = {0, 1, 0}});
  return body;
}

Part moved(Part p, const Vec3d& centre) {
  p.centre = centre;
  return p;
}

/// Sprockets and idlers turn; the shoes' mass rides with the chassis, halfway up the belt.
void add_track(const Vehicle& v, Assembly& a) {
  const Track& t = *v.track;
  for (const double side : {1.0, -1.0}) {
    for (const Part& turning : {t.sprocket, t.idler})
      add_turning(a, moved(turning, turning.centre + Vec3d{0, side * t.offset, 0}), 0, side);
    const Vec3d middle = 0.5 * (t.sprocket.centre + t.idler.centre) + Vec3d{0, side * t.offset, 0.5 * t.road_wheel_z};
    const int count = side > 0 ? t.left_shoes : t.right_shoes;
    a.body[0] = joined(a.body[0], point_mass("", count * t.shoe_mass, middle));
  }
}

/// One side of assemble_without_belts().
void add_running_gear(const Vehicle& v, double side, const Vec3d& idler, Assembly& a) {
  const Track& t = *v.track;
  const Belt& b = *t.belt;
  const Vec3d beside{0, side * t.offset, 0};
  TrackBodies bodies;
  bodies.sprocket = add_turning(a, moved(t.sprocket, t.sprocket.centre + beside), 0, side);
  a.body[0] = joined(a.body[0], point_mass("", -b.carrier_mass, t.idler.centre + beside));
  a.body.push_back({.name = of_side(side, "carrier"),
                    .mass = b.carrier_mass,
                    .centre = idler + beside,
                    .moments = b.carrier_inertia});
  bodies.carrier = int(a.body.size()) - 1;
  a.link.push_back({.type = LinkType::prismatic,
                    .child = bodies.carrier,
                    .point = idler + beside,
                    .axis = direction(t.idler.centre, t.idler_travel)});
  bodies.idler = add_turning(a, moved(t.idler, idler + beside), bodies.carrier, side);
  a.track.push_back(bodies);
}

std::vector<Station> road_wheels(const Vehicle& v) {
  const Track& t = *v.track;
  std::vector<Station> result;
  for (std::size_t i = 0; i < t.road_wheel_x.size(); ++i)
    for (const double side : {1.0, -1.0}) {
      const bool damped = std::find(t.damped.begin(), t.damped.end(), int(i)) != t.damped.end();
      Station s;
      s.name = "road wheel " + std::to_string(i + 1) + (side > 0 ? " left" : " right");
      s.axle = int(i);
      s.side = side;
      s.mount = {side > 0 ? t.road_wheel_x[i] : t.right_road_wheel_x[i], side * t.offset, t.road_wheel_z};
      s.suspension = &find_suspension(v, damped ? t.suspension_with_damper : t.suspension);
      s.wheel = &find_wheel(v, t.wheel);
      s.centre = s.mount + mirrored(s.suspension->point.at("wheel"), side);
      s.driven = true;
      result.push_back(s);
    }
  return result;
}

/// The chassis with what is fixed to it.
Assembly chassis_of(const Vehicle& v) {
  Assembly a;
  a.body.push_back(v.chassis);
  for (const Part& p : v.fixed_parts) a.body[0] = joined(a.body[0], p);
  a.body[0].name = "chassis";
  return a;
}

}  // namespace

Part joined(const Part& a, const Part& b) {
  Part sum = a;
  sum.mass = a.mass + b.mass;
  sum.centre = (a.mass * a.centre + b.mass * b.centre) * (1 / sum.mass);
  Part second = b;
  Part first = a;
  shift(first, a.centre - sum.centre);
  shift(second, b.centre - sum.centre);
  sum.moments = first.moments + second.moments;
  sum.products = first.products + second.products;
  return sum;
}

std::vector<Station> stations(const Vehicle& v) {
  if (v.kind == VehicleKind::tracked) return road_wheels(v);
  std::vector<Station> result;
  for (std::size_t i = 0; i < v.axle.size(); ++i) {
    const Axle& axle = v.axle[i];
    for (const double side : axle.single ? std::vector<double>{0} : std::vector<double>{1, -1}) {
      Station s;
      s.name = axle.single ? axle.name : axle.name + (side > 0 ? " left" : " right");
      s.axle = int(i);
      s.side = side;
      s.mount = axle.position;
      s.suspension = &find_suspension(v, axle.suspension);
      s.wheel = &find_wheel(v, axle.wheel);
      s.mount.y = side < 0 ? -axle.position.y : axle.position.y;
      s.centre = s.mount + mirrored(s.suspension->point.at("wheel"), side);
      s.driven = axle.driven;
      s.brake_torque = axle.brake_torque;
      result.push_back(s);
    }
  }
  return result;
}

Assembly assemble(const Vehicle& v) {
  Assembly a = chassis_of(v);
  if (v.kind == VehicleKind::tracked) add_track(v, a);
  for (const Station& s : stations(v)) add_corner({s, a});
  return a;
}

Assembly assemble_without_belts(const Vehicle& v, const std::vector<Vec3d>& idler) {
  Assembly a = chassis_of(v);
  add_running_gear(v, 1, idler.at(0), a);
  add_running_gear(v, -1, idler.at(1), a);
  for (const Station& s : stations(v)) add_corner({s, a});
  return a;
}

}  // namespace gonogo::vehicle
