// Wheel forces measured on the ground, as a file gives them:
//
//   {"wheels": {"front left": {"normal": {"force_N": 6400, "deviation_N": 60}, "along": {...}, "across": {...}}, ...}}
//
// Wheels and components may be missing.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

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

}  // namespace gonogo::vehicle
