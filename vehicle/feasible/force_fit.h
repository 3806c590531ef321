// Wheel forces measured on the ground, as a file gives them:
//
//   {"wheels": {"front left": {"normal": {"force_N": 6400, "deviation_N": 60}, "along": {...}, "across": {...}}, ...}}
//
// Wheels and components may be missing.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vehicle/feasible/feasible.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

/// Components of a contact force, by the ground on the wheel: out of the ground, forward, left.
inline constexpr const char* kForceComponent[3] = {"normal", "along", "across"};

struct MeasuredForce {
  int contact = 0;       // index of the wheel among the vehicle's stations
  int component = 0;     // of kForceComponent
  double force = 0;      // [N]
  double deviation = 1;  // standard deviation [N]
};

/// Throws InputError for what cannot be read, wheels that the vehicle does not have, deviations below 0.001 N, and a
/// file without any force.
std::vector<MeasuredForce> read_measured_forces(const std::filesystem::path& path, const Vehicle& v);

// Admissible contact forces nearest to measured ones. Admissible are those of feasible.h on a plane: in balance with
// the vehicle's inertia and weight, in the friction cones, with torques in the limits of driveline and brakes.
//
//   minimise |W (D x - data)|   W: 1 / standard deviation, D: the components that were measured
//
// as a second-order cone program: a column t, the cone (t, W (D x - data)), least t. The square of t is chi-square.

/// A component of a contact force [N].
struct FittedForce {
  double force = 0;
  double low = 0, high = 0;  // over all admissible forces whose chi-square is at most 1 above the least
  /// Whether data and equations leave one value; otherwise others in the range fit as well, as far as cones and limits
  /// allow, and `force` is one in the middle.
  bool determined = false;
  std::optional<MeasuredForce> measured;
  double residual = 0;  // fitted less measured, in standard deviations; 0 where not measured
};

struct FittedContact {
  std::string wheel;
  std::array<FittedForce, 3> component;  // as kForceComponent
  double friction_used = 0;              // tangential force over friction times normal force; 0 without load
};

struct ForceFit {
  bool admissible = false;  // whether any forces are; otherwise the rest is empty
  double chi_square = 0;    // sum of squared residuals
  int degrees = 0;          // of freedom of chi-square where no cone or limit binds: data less what they determine
  std::vector<FittedContact> contact;
  std::vector<double> torque;     // of each drive unit [N m]
  std::vector<std::string> unit;  // their names
};

/// Forces are admissible to 1e-6 of the mean wheel load. Throws InputError for what feasible() refuses, for a step, an
/// edge distance, and no data; DeviceError when a cone program does not converge.
ForceFit fit_forces(const Vehicle& v, const Demand& demand, const std::vector<MeasuredForce>& data,
                    const Limits& limits = {});

}  // namespace gonogo::vehicle
