// One line per claim: what was expected, what was measured, the tolerance.
#pragma once
#include <cmath>
#include <cstdio>
#include <string>

namespace gonogo::test {

/// 0.02 rather than 0.020000.
inline std::string short_text(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

/// Prints the line and says whether the two agree.
inline bool agrees(const std::string& claim, double expected, double measured, double tolerance) {
  const bool good = std::abs(measured - expected) <= tolerance;  // false for NaN
  std::printf("%-78s expected %11.6g measured %11.6g tolerance %8.2g%s\n", claim.c_str(), expected, measured, tolerance,
              good ? "" : "  DIFFERS");
  std::fflush(stdout);
  return good;
}

}  // namespace gonogo::test
