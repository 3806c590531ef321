// The virtual tests behind a calibration table.
#pragma once
#include <string>
#include <vector>

#include "terrain/calibration/calibrate.h"

namespace gonogo::terrain {

struct ContactPoint {
  double friction, rolling_friction;
};
using ContactLine = std::vector<ContactPoint>;

/// The line of contact parameters. Sliding friction rises first; rolling friction joins where spheres alone saturate.
/// The friction angle rises by less than about 5 degrees from one point to the next. Sliding friction stays below 1.5:
/// above it pressed beds burst, because the cone program opens sliding contacts at a speed that grows with friction.
const ContactLine& contact_line(GrainShape shape);
/// The points of the line within the run's friction range. Throws InputError for fewer than two.
ContactLine contact_line(const CalibrationRun& run);

/// Settling friction of the packing library, from loose to dense.
inline constexpr double kSettleFriction[] = {0.8, 0.25, 0.02};
inline constexpr double kConfiningStress = 10e3;  // [Pa]; without gravity only the ratios below matter
/// Cohesion pressure between grains over confining stress. At three times the stress, rough grains move in lumps that
/// slide past each other, and the strength is lower than at one times.
inline constexpr double kCohesionRatio[] = {0, 0.5, 1};

enum class TestKind { triaxial, plate, loosest };

/// One test. Its result is empty when the simulation failed; otherwise, by kind:
///   triaxial  axial and lateral stress in steady deformation, then at the peak, over the confining stress; max
///   residual
///             [m/s]
///   plate     k [N/m^(n+2)] and n of p = k z^n, max residual [m/s], solid fraction of the bed
///   loosest   solid fraction of a bed that settles with its own contact laws
struct CalibrationTest {
  TestKind kind;
  std::size_t contact, packing, seed, ratio;  // indices of levels; ratio: of kCohesionRatio
  ContactPoint grains;                        // of that contact level
  std::string name;
  std::vector<double> result{};
};

/// Whether such grains settle more loosely than the library's loosest packing, because they are rougher than the grains
/// that made it.
inline bool settles_loosely(const ContactPoint& p) { return p.rolling_friction > 0 || p.friction > kSettleFriction[0]; }

/// All tests of a run, seed by seed, without results.
std::vector<CalibrationTest> all_tests(const CalibrationRun& run);

/// Fills in the results: from the journal, or by running the test.
void run_tests(std::vector<CalibrationTest>& tests, const CalibrationRun& run);

}  // namespace gonogo::terrain
