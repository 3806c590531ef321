// The one value of gravity: of every trial, bench scene and soil test.
#pragma once

namespace gonogo {

inline constexpr double kGravity = 9.81;  // [m/s^2]

}  // namespace gonogo
