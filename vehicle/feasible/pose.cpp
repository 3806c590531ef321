#include "vehicle/feasible/pose.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

using multibody::Vector3;

/// Nose up about y, vehicle to ground.
multibody::Matrix3 pitched(double pitch) { return Eigen::AngleAxisd(-pitch, Vector3::UnitY()).toRotationMatrix(); }

Contact contact_at(int station, const Vector3& centre, const Vector3& normal, double radius) {
  const Vector3 across = Vector3::UnitY();
  return {.station = station,
          .point = centre - radius * normal,
          .normal = normal,
          .along = across.cross(normal),
          .across = across};
}

/// Normal of a wheel that climbs: from the nearest point of the step, whose edge is at height `step`, to the wheel's
/// centre.
Vector3 climbing_normal(double height, double step, double radius) {
  if (height <= step) return -Vector3::UnitX();  // against the face
  const double up = std::min((height - step) / radius, 1.0);
  return {-std::sqrt(1 - up * up), 0, up};
}

Pose climbing_pose(const Vehicle& v, const std::vector<Station>& wheels, int climber, double rise, double step) {
  // Stations of the two axles: 0, 1 in front of 2, 3, or the other way round.
  const double radius = wheels[0].wheel->radius;
  const int front = wheels[0].centre.x > wheels[2].centre.x ? 0 : 1;
  const bool front_climbs = climber == front;
  const double front_up = front_climbs ? rise : step, rear_up = front_climbs ? 0 : rise;
  const Vec3d &a = wheels[2 * front].centre, &b = wheels[2 * (1 - front)].centre;
  const double base = std::hypot(a.x - b.x, a.z - b.z), drawn = std::asin((a.z - b.z) / base);
  Pose p;
  p.climbing = v.axle[std::size_t(climber)].name;
  p.rise = rise;
  p.pitch = std::asin((front_up - rear_up) / base) - drawn;
  const Vector3 rear = pitched(p.pitch) * multibody::vector(b);
  p.origin = Vector3(0, 0, radius + rear_up) - Vector3(rear.x(), 0, rear.z());
  for (int i = 0; i < 4; ++i) {
    const Vector3 centre = p.origin + pitched(p.pitch) * multibody::vector(wheels[i].centre);
    const bool climbs = wheels[i].axle == climber;
    p.contact.push_back(
        contact_at(i, centre, climbs ? climbing_normal(radius + rise, step, radius) : Vector3::UnitZ(), radius));
  }
  return p;
}

}  // namespace

Pose level_pose(const Vehicle& v) {
  const double ground = weigh(v).ground;
  Pose p;
  p.origin = {0, 0, -ground};
  const auto wheels = stations(v);
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const Vector3 centre = p.origin + multibody::vector(wheels[i].centre);
    p.contact.push_back(contact_at(int(i), centre, Vector3::UnitZ(), centre.z()));
  }
  return p;
}

std::vector<Pose> step_poses(const Vehicle& v, double step) {
  constexpr int kRises = 24;
  const auto wheels = stations(v);
  if (v.kind != VehicleKind::wheeled || v.axle.size() != 2 || wheels.size() != 4)
    throw InputError(v.name + ": steps are for wheeled vehicles on two axles; leave the step out");
  if (wheels[0].wheel->radius != wheels[2].wheel->radius)
    throw InputError(v.name + ": steps are for vehicles with equal wheels; leave the step out");
  const double base = std::fabs(wheels[0].centre.x - wheels[2].centre.x);
  if (!(step < 0.9 * base))
    throw InputError("a step of " + number_text(step) + " m is as high as the wheelbase is long");
  std::vector<Pose> poses;
  for (const int climber : {0, 1})
    for (int i = 0; i <= kRises; ++i) poses.push_back(climbing_pose(v, wheels, climber, step * i / kRises, step));
  return poses;
}

Assembly locked(const Vehicle& v) {
  const Assembly whole = assemble(v);
  const bool turning = v.kind != VehicleKind::tracked;
  Assembly rigid;
  rigid.body.push_back(whole.body[0]);
  for (std::size_t i = 1; i < whole.body.size(); ++i)
    if (!turning || std::find(whole.wheel.begin(), whole.wheel.end(), int(i)) == whole.wheel.end())
      rigid.body[0] = joined(rigid.body[0], whole.body[i]);
  if (!turning) return rigid;
  for (const int wheel : whole.wheel) {
    const Part& part = whole.body[std::size_t(wheel)];
    rigid.body.push_back(part);
    rigid.wheel.push_back(int(rigid.body.size()) - 1);
    rigid.link.push_back({.child = rigid.wheel.back(), .point = part.centre, .axis = {0, 1, 0}, .wheel = true});
  }
  return rigid;
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
