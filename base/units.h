// Units in SI, and the Earth's gravity: of every bench scene and soil test, and of trials whose study names no other.
// Code holds angles in radians; files and options give degrees.
#pragma once
#include <numbers>

#include "base/host_device.h"

namespace gonogo {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;  // [rad]
inline constexpr double kDegreesPerRadian = 180 / kPi;
inline constexpr double kInch = 0.0254;              // [m]
inline constexpr double kKmPerHour = 3.6;            // of one metre per second
inline constexpr double kPoundForce = 4.4482216153;  // [N]
inline constexpr double kPsi = 6894.757;             // pound-force per square inch [Pa]
inline constexpr double kGravity = 9.81;             // that soils and vehicles are calibrated at [m/s^2]

/// Multiply first, divide second: the last bit may differ from that of `x * kDegree`.
GONOGO_HD constexpr double to_radians(double degrees) { return degrees * kPi / 180; }
GONOGO_HD constexpr double to_degrees(double radians) { return radians * 180 / kPi; }

}  // namespace gonogo
