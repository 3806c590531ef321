// Poses of a rigid vehicle on the ground, with their contacts.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "vehicle/feasible/cone_program.h"
#include "vehicle/feasible/feasible.h"
#include "vehicle/multibody/vehicle_tree.h"

namespace gonogo::vehicle {

struct Contact {
  int station = 0;
  multibody::Vector3 point;                  // in the frame of the ground [m]
  multibody::Vector3 normal, along, across;  // unit vectors
};

struct Pose {
  double pitch = 0;           // nose up [rad]
  multibody::Vector3 origin;  // of the vehicle in the frame of the ground [m]
  std::vector<Contact> contact;
  std::string climbing;  // axle at the step
  double rise = 0;       // of its wheels above the foot [m]
};

/// Pose on the plane.
Pose level_pose(const Vehicle& v);

/// Poses of each axle climbing a step, from foot to top.
std::vector<Pose> step_poses(const Vehicle& v, double step);

/// The vehicle with its suspension locked. Its wheels still turn.
Assembly locked(const Vehicle& v);

// The constraints of a vehicle's contact forces and torques at a pose, as those of a cone program: inverse dynamics,
// driveline, friction cones, torque limits.

/// Feasible when the reserve is not below this: what the solver leaves.
constexpr double kLeastReserve = -1e-7;

/// What a torque acts through: a wheel, or the sprocket of a track.
struct TorqueUnit {
  std::string name;
  std::vector<int> contact{};
  int axle = 0;
  int velocity = -1;  // of the wheel's axle in the tree; -1: through a belt
  double lever = 0;   // of the belt's force [m]
  double brake = 0;   // [N m]
  bool driven = false;
};

/// Forces are in mean wheel loads, torques in those times the drive radius; the columns are (normal, along, across) of
/// each contact, the torque of each unit, the reserve, the share of the torque limits. Keeps references to its
/// arguments.
class ForceProgram {
 public:
  ForceProgram(const Vehicle& v, const Pose& pose, const Demand& demand, const Limits& limits);

  int contacts() const { return int(pose_.contact.size()); }
  int columns() const { return columns_; }
  int torque(int unit) const { return 3 * contacts() + unit; }
  int reserve() const { return columns_ - 2; }
  int share() const { return columns_ - 1; }
  double load() const { return load_; }      // [N]
  double radius() const { return radius_; }  // [m]
  const std::vector<TorqueUnit>& units() const { return units_; }

  /// The constraints with some columns held at a value, and nothing to minimise.
  ConeProgram constraints(const std::vector<std::pair<int, double>>& held) const;

  /// The answer with the largest reserve at the full torque limits, or with the smallest share of them at no reserve.
  ConeAnswer answer(bool largest_reserve) const;

 private:
  using VectorX = multibody::VectorX;
  using MatrixX = multibody::MatrixX;
  enum class Source { drive, brakes, parked };  // of torques

  MatrixX stacked(const std::vector<VectorX>& rows) const;
  void equate(const VectorX& row, double value);
  void require(const VectorX& row);
  void balance();
  void add_equations(const MatrixX& transposed, const VectorX& needed);
  Source source() const;
  VectorX sum_of(const std::vector<int>& units) const;
  void couple(Differential kind, double bias, const std::vector<int>& first, const std::vector<int>& second,
              double first_share);
  void driveline();
  void normals(bool friction);
  double motor() const;
  double driven_count() const;
  bool can_brake(const TorqueUnit& u) const;
  void limit(const VectorX& sum, double torque);
  void torque_limits();

  const Vehicle& vehicle_;
  const Pose& pose_;
  const Demand& demand_;
  multibody::VehicleTree tree_;
  std::vector<TorqueUnit> units_;
  double load_ = 1, radius_ = 1;
  int columns_ = 0;
  Source source_ = Source::drive;
  std::vector<VectorX> equation_, row_;
  std::vector<double> right_;
  std::vector<int> cone_;
};

}  // namespace gonogo::vehicle
