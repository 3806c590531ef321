#include "vehicle/feasible/feasible.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "vehicle/feasible/cone_program.h"
#include "vehicle/feasible/pose.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

using multibody::MatrixX;
using multibody::Vector3;
using multibody::VectorX;

/// Feasible when the reserve is not below this: what the solver leaves.
constexpr double kNone = -1e-7;

/// What a torque acts through: a wheel, or the sprocket of a track.
struct Unit {
  std::string name;
  std::vector<int> contact{};
  int axle = 0;
  int velocity = -1;  // of the wheel's axle in the tree; -1: through a belt
  double lever = 0;   // of the belt's force [m]
  double brake = 0;   // [N m]
  bool driven = false;
};

std::vector<Unit> units_of(const Vehicle& v, const multibody::VehicleTree& tree) {
  const auto wheels = stations(v);
  std::vector<Unit> units;
  if (v.kind == VehicleKind::tracked) {
    for (const double side : {1.0, -1.0}) {
      Unit u{.name = side > 0 ? "left track" : "right track",
             .lever = v.track[0].sprocket_radius,
             .brake = v.track[0].brake_torque,
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

/// How torques are made.
enum class Source { drive, brakes, parked };

/// The cone program of a pose. Forces are in mean wheel loads, torques in those times the drive radius; the columns are
/// (normal, along, across) of each contact, the torque of each unit, the reserve, the share of the torque limits.
class Program {
 public:
  Program(const Vehicle& v, const Pose& pose, const Demand& demand, const Limits& limits)
      : vehicle_(v),
        pose_(pose),
        demand_(demand),
        tree_(multibody::vehicle_tree(locked(v))),
        units_(units_of(v, tree_)) {
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

  int contacts() const { return int(pose_.contact.size()); }
  int torque(int unit) const { return 3 * contacts() + unit; }
  int reserve() const { return columns_ - 2; }
  int share() const { return columns_ - 1; }
  double load() const { return load_; }
  double radius() const { return radius_; }
  const std::vector<Unit>& units() const { return units_; }

  /// With the largest reserve at the full torque limits, or the smallest share of them at no reserve.
  ConeAnswer answer(bool largest_reserve) const {
    ConeProgram p;
    p.c = VectorX::Zero(columns_);
    p.c(largest_reserve ? reserve() : share()) = largest_reserve ? -1 : 1;
    auto equations = equation_;
    auto right = right_;
    equations.push_back(VectorX::Unit(columns_, largest_reserve ? share() : reserve()));
    right.push_back(largest_reserve ? 1 : 0);
    p.A = stacked(equations);
    p.b = Eigen::Map<const VectorX>(right.data(), Eigen::Index(right.size()));
    p.G = -stacked(row_);
    p.h = VectorX::Zero(p.G.rows());
    p.cone = cone_;
    return solve(p);
  }

 private:
  MatrixX stacked(const std::vector<VectorX>& rows) const {
    MatrixX m(Eigen::Index(rows.size()), columns_);
    for (std::size_t i = 0; i < rows.size(); ++i) m.row(Eigen::Index(i)) = rows[i].transpose();
    return m;
  }
  void equate(const VectorX& row, double value) {
    equation_.push_back(row);
    right_.push_back(value);
  }
  /// row . x >= 0.
  void require(const VectorX& row) {
    row_.push_back(row);
    cone_.push_back(1);
  }

  /// Inverse dynamics: joint forces needed = sum of J^T f + torques.
  void balance() {
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

  void add_equations(const MatrixX& transposed, const VectorX& needed) {
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
  Source source() const {
    if (!demand_.moving) return Source::parked;
    const double along = demand_.acceleration - demand_.gravity.x;
    return pose_.climbing.empty() && along < 0 ? Source::brakes : Source::drive;
  }

  VectorX sum_of(const std::vector<int>& units) const {
    VectorX row = VectorX::Zero(columns_);
    for (const int u : units) row(torque(u)) = 1;
    return row;
  }

  /// Two groups whose torques stand in proportion first_share : 1 - first_share, or differ within a bias, or not at
  /// all.
  void couple(Differential kind, double bias, const std::vector<int>& first, const std::vector<int>& second,
              double first_share) {
    if (kind == Differential::locked) return;
    const VectorX a = (1 - first_share) * sum_of(first), b = first_share * sum_of(second);
    // Without a force along the plane there is no torque to share out; equality says so and leaves an interior.
    const bool idle = pose_.climbing.empty() && std::fabs(demand_.acceleration - demand_.gravity.x) < 1e-9;
    if (kind == Differential::open || idle || bias <= 1) return equate(a - b, 0);
    require(bias * b - a);
    require(bias * a - b);
  }

  void driveline() {
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

  void normals(bool friction) {
    for (int i = 0; i < contacts(); ++i) {
      const VectorX pressed = VectorX::Unit(columns_, 3 * i) - VectorX::Unit(columns_, reserve());
      if (!friction) {
        require(pressed);
        continue;
      }
      row_.push_back(demand_.friction * pressed);
      row_.push_back(VectorX::Unit(columns_, 3 * i + 1));
      row_.push_back(VectorX::Unit(columns_, 3 * i + 2));
      cone_.push_back(3);
    }
  }

  double motor() const { return vehicle_.driveline.wheel_motors ? largest_drive_torque(vehicle_) / driven_count() : 0; }
  double driven_count() const {
    return double(std::count_if(units_.begin(), units_.end(), [](const Unit& u) { return u.driven; }));
  }
  /// Wheel motors hold as well as they drive.
  bool can_brake(const Unit& u) const { return u.brake > 0 || (u.driven && motor() > 0); }

  /// |sum of torques| <= share * limit - reserve.
  void limit(const VectorX& sum, double torque) {
    VectorX room = -VectorX::Unit(columns_, reserve());
    room(share()) = torque / (load_ * radius_);
    require(room - sum);
    require(room + sum);
  }

  void torque_limits() {
    std::vector<int> driven;
    for (std::size_t u = 0; u < units_.size(); ++u) {
      const Unit& unit = units_[u];
      if (unit.driven) driven.push_back(int(u));
      const bool alone = source_ == Source::drive ? unit.driven && motor() > 0 : can_brake(unit);
      if (alone) limit(sum_of({int(u)}), motor() + (source_ == Source::drive ? 0 : unit.brake));
    }
    if (source_ == Source::drive && motor() == 0) limit(sum_of(driven), largest_drive_torque(vehicle_));
  }

  const Vehicle& vehicle_;
  const Pose& pose_;
  const Demand& demand_;
  multibody::VehicleTree tree_;
  std::vector<Unit> units_;
  double load_ = 1, radius_ = 1;
  int columns_ = 0;
  Source source_ = Source::drive;
  std::vector<VectorX> equation_, row_;
  std::vector<double> right_;
  std::vector<int> cone_;
};

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

Feasibility result_of(const Vehicle& v, const Pose& pose, const Program& program, const ConeAnswer& a) {
  Feasibility f;
  f.pitch = pose.pitch;
  f.rise = pose.rise;
  f.climbing = pose.climbing;
  f.reserve = a.consistent ? a.x(program.reserve()) : -std::numeric_limits<double>::infinity();
  if (a.consistent && !a.solved) throw DeviceError(v.name + ": the cone program did not converge");
  f.feasible = f.reserve >= kNone;
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
bool stands(const Vehicle& v, const Demand& d, const Limits& limits) { return feasible(v, d, limits).reserve >= kNone; }

}  // namespace

Feasibility feasible(const Vehicle& v, const Demand& demand, const Limits& limits) {
  check(demand);
  Feasibility worst;
  worst.reserve = std::numeric_limits<double>::infinity();
  for (const Pose& pose : poses_of(v, demand)) {
    const Program program(v, pose, demand, limits);
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
    const Program unlimited(v, pose, demand, {true, false});
    const ConeAnswer room = unlimited.answer(true);
    if (!room.consistent || room.x(unlimited.reserve()) < 1e-6) return std::numeric_limits<double>::infinity();
    const Program program(v, pose, demand, {true, true});
    share = std::max(share, program.answer(false).x(program.share()));
  }
  return share;
}

}  // namespace gonogo::vehicle
