#include "vehicle/feasible/feasible.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "vehicle/feasible/force_program.h"

namespace gonogo::vehicle {
namespace {

using multibody::Vector3;

void check(const Demand& d) {
  if (!(d.friction >= 1e-3 && d.friction <= 100))
    throw InputError("a friction coefficient of " + number_text(d.friction, 6) + " is outside 0.001 to 100");
  if (!(d.step >= 0)) throw InputError("a step of " + number_text(d.step) + " m; give a height of at least 0");
  if (!(d.edge_distance >= 0))
    throw InputError("a distance of " + number_text(d.edge_distance) + " m from the edge; give at least 0");
  if (d.edge_distance > 0 && d.step > 0)
    throw InputError("the distance from the edge is for a plane; leave it or the step out");
  if (!(length(d.gravity) > 0 && d.gravity.z < 0)) throw InputError("gravity must point into the ground");
}

std::vector<Pose> poses_of(const Vehicle& v, const Demand& d) {
  return d.step > 0 ? step_poses(v, d.step) : std::vector<Pose>{level_pose(v)};
}

Feasibility result_of(const Vehicle& v, const Pose& pose, const ForceProgram& program, const ConeAnswer& a) {
  Feasibility f;
  f.pitch = pose.pitch;
  f.rise = pose.rise;
  f.climbing = pose.climbing;
  f.reserve = a.consistent ? a.x(program.reserve()) : -std::numeric_limits<double>::infinity();
  if (a.consistent && !a.solved) throw DeviceError(v.name + ": the cone program did not converge");
  f.feasible = f.reserve >= kLeastReserve;
  if (!a.consistent) return f;
  const auto wheels = stations(v);
  for (int i = 0; i < program.contacts(); ++i)
    f.contact.push_back({wheels[std::size_t(pose.contact[std::size_t(i)].station)].name, a.x(3 * i) * program.load(),
                         a.x(3 * i + 1) * program.load(), a.x(3 * i + 2) * program.load()});
  for (std::size_t u = 0; u < program.units().size(); ++u) {
    f.unit.push_back(program.units()[u].name);
    f.torque.push_back(a.x(program.torque(int(u))) * program.load() * program.radius());
  }
  return f;
}

/// Twice the area of the triangle a b c; positive when it turns left.
double turn(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Corners of the convex hull in counter-clockwise order (Andrew's monotone chain).
std::vector<Vec3d> hull_of(std::vector<Vec3d> point) {
  std::sort(point.begin(), point.end(),
            [](const Vec3d& a, const Vec3d& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<Vec3d> hull;
  const auto add = [&](const Vec3d& p, std::size_t kept) {
    while (hull.size() > kept && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec3d& p : point) add(p, 1);
  const std::size_t lower = hull.size();
  for (auto p = point.rbegin() + 1; p != point.rend(); ++p) add(*p, lower);
  hull.pop_back();
  return hull;
}

/// Centre of pressure of normal forces, whose sum is not 0, at points of a plane; z is left out. None where the hull
/// has no area.
std::optional<Pressure> centre_of_pressure(const std::vector<Vec3d>& point, const std::vector<double>& normal) {
  if (point.size() < 3) return std::nullopt;
  const std::vector<Vec3d> hull = hull_of(point);
  if (hull.size() < 3) return std::nullopt;
  Vec3d centre;
  double sum = 0;
  for (std::size_t i = 0; i < point.size(); ++i) {
    centre += normal[i] * point[i];
    sum += normal[i];
  }
  centre *= 1 / sum;
  Pressure p{centre.x, centre.y, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec3d &a = hull[i], &b = hull[(i + 1) % hull.size()];
    p.edge = std::min(p.edge, turn(a, b, centre) / std::hypot(b.x - a.x, b.y - a.y));
  }
  return p;
}

/// On a plane, in the vehicle's frame.
std::optional<Pressure> pressure_of(const Pose& pose, const Feasibility& f) {
  std::vector<Vec3d> point;
  std::vector<double> normal;
  for (std::size_t i = 0; i < f.contact.size(); ++i) {
    const Vector3 at = pose.contact[i].point - pose.origin;
    point.push_back({at.x(), at.y(), at.z()});
    normal.push_back(f.contact[i].normal);
  }
  return centre_of_pressure(point, normal);
}

/// Whether it would do with these limits, belly and edge left out.
bool stands(const Vehicle& v, const Demand& d, const Limits& limits) {
  return feasible(v, d, limits).reserve >= kLeastReserve;
}

}  // namespace

Feasibility feasible(const Vehicle& v, const Demand& demand, const Limits& limits) {
  check(demand);
  Feasibility worst;
  worst.reserve = std::numeric_limits<double>::infinity();
  for (const Pose& pose : poses_of(v, demand)) {
    const ForceProgram program(v, pose, demand, limits);
    Feasibility here = result_of(v, pose, program, program.answer(true));
    if (demand.step == 0) here.pressure = pressure_of(pose, here);
    if (here.reserve < worst.reserve) worst = here;
  }
  if (demand.step > 0 && needed_clearance(v, demand.step) > v.clearance) worst.feasible = false;
  const bool is_limited = demand.edge_distance > 0 && worst.pressure.has_value();
  if (is_limited && worst.pressure->edge < demand.edge_distance) worst.feasible = false;
  return worst;
}

std::string limiting_cause(const Vehicle& v, const Demand& demand) {
  if (feasible(v, demand).feasible) return "";
  if (!stands(v, demand, {false, false})) return "tip-over";
  if (stands(v, demand, {true, true})) return demand.step > 0 ? "belly" : "centre of pressure";
  const bool with_torque = stands(v, demand, {true, false}), with_friction = stands(v, demand, {false, true});
  if (with_torque && with_friction) return "traction or torque";
  if (with_torque) return "torque";
  return with_friction ? "traction" : "traction and torque";
}

double min_friction(const Vehicle& v, Demand demand) {
  double low = 1e-3, high = 100;
  const auto enough = [&](double friction) {
    demand.friction = friction;
    return stands(v, demand, {true, true});
  };
  if (!enough(high)) return std::numeric_limits<double>::infinity();
  if (enough(low)) return 0;
  while (high / low > 1 + 1e-6) {
    const double middle = std::sqrt(low * high);
    (enough(middle) ? high : low) = middle;
  }
  return high;
}

double min_torque_share(const Vehicle& v, const Demand& demand) {
  double share = 0;
  for (const Pose& pose : poses_of(v, demand)) {
    // Without room in the cones the program has no interior.
    const ForceProgram unlimited(v, pose, demand, {true, false});
    const ConeAnswer room = unlimited.answer(true);
    if (!room.consistent || room.x(unlimited.reserve()) < 1e-6) return std::numeric_limits<double>::infinity();
    const ForceProgram program(v, pose, demand, {true, true});
    share = std::max(share, program.answer(false).x(program.share()));
  }
  return share;
}

double needed_clearance(const Vehicle& v, double step) {
  const auto wheels = stations(v);
  const double radius = wheels[0].wheel->radius, base = std::fabs(wheels[0].centre.x - wheels[2].centre.x);
  const double pitch = std::asin(std::min(step / base, 1.0));
  // Height of the edge over the plane that touches all wheels from below, where the belly begins: one radius before the
  // rear axle, the edge deepest inside.
  return std::max(0.0, radius - radius * std::tan(pitch) + (step - radius) / std::cos(pitch));
}

}  // namespace gonogo::vehicle
