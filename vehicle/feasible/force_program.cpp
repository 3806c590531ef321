#include "vehicle/feasible/force_program.h"

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

std::vector<TorqueUnit> units_of(const Vehicle& v, const multibody::VehicleTree& tree) {
  const auto wheels = stations(v);
  std::vector<TorqueUnit> units;
  if (v.kind == VehicleKind::tracked) {
    for (const double side : {1.0, -1.0}) {
      TorqueUnit u{.name = side > 0 ? "left track" : "right track",
                   .lever = v.track->sprocket_radius,
                   .brake = v.track->brake_torque,
                   .driven = true};
      for (std::size_t i = 0; i < wheels.size(); ++i)
        if (wheels[i].side == side) u.contact.push_back(int(i));
      units.push_back(u);
    }
    return units;
  }
  for (std::size_t i = 0; i < wheels.size(); ++i)
    units.push_back({.name = wheels[i].name,
                     .contact = {int(i)},
                     .axle = wheels[i].axle,
                     .velocity = tree.axle[i],
                     .brake = wheels[i].brake_torque,
                     .driven = wheels[i].driven});
  return units;
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

using multibody::MatrixX;
using multibody::Vector3;
using multibody::VectorX;

ForceProgram::ForceProgram(const Vehicle& v, const Pose& pose, const Demand& demand, const Limits& limits)
    : vehicle_(v), pose_(pose), demand_(demand), tree_(multibody::vehicle_tree(locked(v))), units_(units_of(v, tree_)) {
  load_ = weigh(v).total * length(demand.gravity) / double(pose.contact.size());
  radius_ = drive_radius(v);
  columns_ = 3 * contacts() + int(units_.size()) + 2;
  balance();
  source_ = source();
  driveline();
  normals(limits.friction);
  if (limits.torque) torque_limits();
  // A wheel wedged against a step can press without bound; on a plane this never binds.
  require(VectorX::Unit(columns_, share()) - VectorX::Unit(columns_, reserve()));
}

ConeProgram ForceProgram::constraints(const std::vector<std::pair<int, double>>& held) const {
  ConeProgram p;
  p.c = VectorX::Zero(columns_);
  auto equations = equation_;
  auto right = right_;
  for (const auto& [column, value] : held) {
    equations.push_back(VectorX::Unit(columns_, column));
    right.push_back(value);
  }
  p.A = stacked(equations);
  p.b = Eigen::Map<const VectorX>(right.data(), Eigen::Index(right.size()));
  p.G = -stacked(row_);
  p.h = VectorX::Zero(p.G.rows());
  p.cone = cone_;
  return p;
}

ConeAnswer ForceProgram::answer(bool largest_reserve) const {
  ConeProgram p = constraints({largest_reserve ? std::pair(share(), 1.0) : std::pair(reserve(), 0.0)});
  p.c(largest_reserve ? reserve() : share()) = largest_reserve ? -1 : 1;
  return solve(p);
}

MatrixX ForceProgram::stacked(const std::vector<VectorX>& rows) const {
  MatrixX m(Eigen::Index(rows.size()), columns_);
  for (std::size_t i = 0; i < rows.size(); ++i) m.row(Eigen::Index(i)) = rows[i].transpose();
  return m;
}
void ForceProgram::equate(const VectorX& row, double value) {
  equation_.push_back(row);
  right_.push_back(value);
}
/// row . x >= 0.
void ForceProgram::require(const VectorX& row) {
  row_.push_back(row);
  cone_.push_back(1);
}

/// Inverse dynamics: joint forces needed = sum of J^T f + torques.
void ForceProgram::balance() {
  const multibody::Tree& tree = tree_.tree;
  VectorX q = tree.zero_position(), dv = VectorX::Zero(tree.velocity_count());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-pose_.pitch, Vector3::UnitY()));
  q.head<7>() << turn.w(), turn.x(), turn.y(), turn.z(), pose_.origin;
  dv.segment<3>(3) = turn.conjugate() * Vector3(demand_.acceleration, 0, 0);
  const auto wheels = stations(vehicle_);
  for (std::size_t i = 0; i < tree_.axle.size(); ++i)
    dv(tree_.axle[i]) = demand_.acceleration / wheels[i].wheel->radius;
  const VectorX rest = VectorX::Zero(tree.velocity_count());
  const VectorX needed = multibody::inverse_dynamics(tree, q, rest, dv, multibody::vector(demand_.gravity)) / load_;
  const auto k = multibody::kinematics(tree, q, rest);
  MatrixX transposed = MatrixX::Zero(tree.velocity_count(), columns_);
  for (int i = 0; i < contacts(); ++i) {
    const Contact& c = pose_.contact[std::size_t(i)];
    const int body = tree_.axle.empty() ? 0 : c.station + 1;
    const MatrixX jacobian = multibody::point_jacobian(tree, k, body, k.from_world[std::size_t(body)].point(c.point));
    multibody::Matrix3 directions;
    directions << c.normal, c.along, c.across;
    transposed.middleCols(3 * i, 3) = jacobian.transpose() * directions;
  }
  add_equations(transposed, needed);
}

void ForceProgram::add_equations(const MatrixX& transposed, const VectorX& needed) {
  // The carriage of a rig is guided: it only runs along and rises.
  const std::vector<int> free =
      vehicle_.kind == VehicleKind::single_wheel ? std::vector<int>{3, 5} : std::vector<int>{0, 1, 2, 3, 4, 5};
  for (const int row : free) equate(transposed.row(row).transpose(), needed(row));
  for (std::size_t u = 0; u < units_.size(); ++u) {
    VectorX row = VectorX::Zero(columns_);
    double value = 0;
    if (units_[u].velocity >= 0) {
      row = transposed.row(units_[u].velocity).transpose();
      value = needed(units_[u].velocity);
    } else {
      for (const int c : units_[u].contact) row(3 * c + 1) = -units_[u].lever;
    }
    row(torque(int(u))) = radius_;
    equate(row, value);
  }
  if (vehicle_.kind == VehicleKind::single_wheel) equate(VectorX::Unit(columns_, 2), 0);
}

/// On a plane the sign of the force along it says whether the vehicle is driven or braked.
ForceProgram::Source ForceProgram::source() const {
  if (!demand_.moving) return Source::parked;
  const double along = demand_.acceleration - demand_.gravity.x;
  return pose_.climbing.empty() && along < 0 ? Source::brakes : Source::drive;
}

VectorX ForceProgram::sum_of(const std::vector<int>& units) const {
  VectorX row = VectorX::Zero(columns_);
  for (const int u : units) row(torque(u)) = 1;
  return row;
}

/// Two groups whose torques stand in proportion first_share : 1 - first_share, or differ within a bias, or not at
/// all.
void ForceProgram::couple(Differential kind, double bias, const std::vector<int>& first, const std::vector<int>& second,
                          double first_share) {
  if (kind == Differential::locked) return;
  const VectorX a = (1 - first_share) * sum_of(first), b = first_share * sum_of(second);
  // Without a force along the plane there is no torque to share out; equality says so and leaves an interior.
  const bool idle = pose_.climbing.empty() && std::fabs(demand_.acceleration - demand_.gravity.x) < 1e-9;
  if (kind == Differential::open || idle || bias <= 1) return equate(a - b, 0);
  require(bias * b - a);
  require(bias * a - b);
}

void ForceProgram::driveline() {
  for (std::size_t u = 0; u < units_.size(); ++u)
    if (source_ == Source::drive ? !units_[u].driven : !can_brake(units_[u]))
      equate(VectorX::Unit(columns_, torque(int(u))), 0);
  const Driveline& d = vehicle_.driveline;
  if (source_ != Source::drive || d.wheel_motors) return;
  if (vehicle_.kind == VehicleKind::tracked) return couple(d.centre, d.centre_bias, {0}, {1}, 0.5);
  std::vector<std::vector<int>> axles;
  for (std::size_t i = 0; i < vehicle_.axle.size(); ++i) {
    const Axle& axle = vehicle_.axle[i];
    if (!axle.driven) continue;
    axles.emplace_back();
    for (std::size_t u = 0; u < units_.size(); ++u)
      if (units_[u].axle == int(i)) axles.back().push_back(int(u));
    if (axles.back().size() == 2)
      couple(axle.differential, axle.torque_bias, {axles.back()[0]}, {axles.back()[1]}, 0.5);
  }
  for (std::size_t i = 1; i < axles.size(); ++i)
    couple(d.centre, d.centre_bias, axles[i - 1], axles[i], axles.size() == 2 ? d.front_share : 0.5);
}

void ForceProgram::normals(bool friction) {
  for (int i = 0; i < contacts(); ++i) {
    const VectorX pressed = VectorX::Unit(columns_, 3 * i) - VectorX::Unit(columns_, reserve());
    if (!friction) {
      require(pressed);
      continue;
    }
    const double scale = std::max(1.0, demand_.friction);  // rows of size 1 converge
    row_.push_back(demand_.friction / scale * pressed);
    row_.push_back(VectorX::Unit(columns_, 3 * i + 1) / scale);
    row_.push_back(VectorX::Unit(columns_, 3 * i + 2) / scale);
    cone_.push_back(3);
  }
}

double ForceProgram::motor() const {
  return vehicle_.driveline.wheel_motors ? largest_drive_torque(vehicle_) / driven_count() : 0;
}
double ForceProgram::driven_count() const {
  return double(std::count_if(units_.begin(), units_.end(), [](const TorqueUnit& u) { return u.driven; }));
}
/// Wheel motors hold as well as they drive.
bool ForceProgram::can_brake(const TorqueUnit& u) const { return u.brake > 0 || (u.driven && motor() > 0); }

/// |sum of torques| <= share * limit - reserve.
void ForceProgram::limit(const VectorX& sum, double torque) {
  VectorX room = -VectorX::Unit(columns_, reserve());
  room(share()) = torque / (load_ * radius_);
  require(room - sum);
  require(room + sum);
}

void ForceProgram::torque_limits() {
  std::vector<int> driven;
  for (std::size_t u = 0; u < units_.size(); ++u) {
    const TorqueUnit& unit = units_[u];
    if (unit.driven) driven.push_back(int(u));
    const bool alone = source_ == Source::drive ? unit.driven && motor() > 0 : can_brake(unit);
    if (alone) limit(sum_of({int(u)}), motor() + (source_ == Source::drive ? 0 : unit.brake));
  }
  if (source_ == Source::drive && motor() == 0) limit(sum_of(driven), largest_drive_torque(vehicle_));
}

}  // namespace gonogo::vehicle
