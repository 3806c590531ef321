// The virtual tests that a calibration table is made of, and their journal.
#pragma once
#include <string>
#include <vector>

#include "terrain/calibration/calibrate.h"

namespace gonogo::terrain {

struct ContactPoint {
  double friction, rolling_friction;
};
using ContactLine = std::vector<ContactPoint>;

/// The line of contact parameters: sliding friction first, rolling friction joins where spheres alone saturate. So
/// close that the friction angle rises by less than about 5 degrees from one to the next. Sliding friction above 1.5
/// makes beds burst that are pressed: the cone program lets sliding contacts open, the faster the rougher they are.
const ContactLine& contact_line(GrainShape shape);
/// What a run takes of it. Throws InputError for fewer than two levels.
ContactLine contact_line(const CalibrationRun& run);

/// Settling friction of the packing library, from loose to dense.
inline constexpr double kSettleFriction[] = {0.8, 0.25, 0.02};
inline constexpr double kConfiningStress = 10e3;  // [Pa]; without gravity only the ratios below matter
/// Cohesion pressure between grains over confining stress. At three times the stress rough grains move in lumps that
/// slide past each other, and less is carried than at once.
inline constexpr double kCohesionRatio[] = {0, 0.5, 1};

enum class TestKind { triaxial, plate, loosest };

/// One test. Its result is empty where the simulation failed; triaxial: axial and lateral stress of steady deformation
/// and of the peak over the confining stress, worst residual [m/s]; plate: k [N/m^(n+2)], n of p = k z^n, worst
/// residual, solid fraction of the bed; loosest: solid fraction of a bed that settles with its own contact laws.
struct CalibrationTest {
  TestKind kind;
  std::size_t contact, packing, seed, ratio;
  ContactPoint grains;  // of that contact level
  std::string name;
  std::vector<double> result{};
};

/// Whether such grains settle more loosely than the library's loosest packing: they are rougher than those that made
/// it.
inline bool settles_loosely(const ContactPoint& p) { return p.rolling_friction > 0 || p.friction > kSettleFriction[0]; }

/// All tests of a run, without results, one seed after the other.
std::vector<CalibrationTest> all_tests(const CalibrationRun& run);

/// Fills in the results, from the journal where it has them.
void run_tests(std::vector<CalibrationTest>& tests, const CalibrationRun& run);

}  // namespace gonogo::terrain
