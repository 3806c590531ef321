// What grains and state of a soil all of its tests together speak for, and which of them disagree.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "terrain/soil/soil.h"

namespace gonogo::terrain {

/// A number of a test, beside what the posterior's soil shows in that test.
struct Evidence {
  std::string what;              // "direct shear, peak: friction angle [deg]"
  double given = 0, error = 0;   // error: of measurement, table and formula together
  double shown = 0, spread = 0;  // mean and standard deviation over the posterior
  double deviation() const { return (given - shown) / error; }
};

/// Mean and standard deviation.
struct Estimated {
  double mean = 0, error = 0;
};

struct SoilPosterior {
  Estimated friction_angle, cohesion;    // of triaxial compression, peak [deg], [kPa]
  Estimated friction, rolling_friction;  // of the contacts [-]
  std::vector<double> packing;           // probability of each packing of the table
  std::vector<Evidence> evidence;
  std::vector<std::string> disagreements;  // one sentence each
  std::vector<std::string> left_out;       // one sentence each: tests that say nothing here, and why
};

/// Posterior on a grid over the table's line of contacts, its packings and cohesion. The prior is uniform in triaxial
/// angle and in cohesion up to 100 kPa, and of the packings as the soil's range of relative density has it. Numbers of
/// tests are independent and normal: a range counts as uniform (its half width over sqrt 3), one value as known to 1
/// degree or a tenth; the table's own error and, for a cone index, a quarter of the index for the formula are added.
/// Plates count by the logarithm of their pressure at one grain's depth, known to a factor of two. Cone gradients, and
/// cone indices of coarse soil, count by their logarithms where the table holds cones, known to a factor of 1.6. An
/// angle disagrees with another, or a strength with another, where both miss what they are given by more than two
/// errors in opposite directions; alone, one that misses by more than three. Throws InputError where the state's tests
/// leave no contact of the table possible.
SoilPosterior soil_posterior(const Calibration& calibration, const SoilState& state);

/// The soil's strength as it acts at a normal stress [Pa] outside of those it was tested at. Envelopes of soil are
/// curved: a power law tau = A sigma^b through both ends of the tested line takes its place (Baker 2004, "Nonlinear
/// Mohr envelopes based on triaxial data", J. Geotech. Geoenviron. Eng. 130, 498-506), and angle and cohesion are those
/// of its tangent. So an intercept fitted far above becomes a cohesion that vanishes with the stress. Inside, or
/// without cohesion, the soil is unchanged. `tested`: normal stresses [Pa], 0 < low < high.
MacroscopicSoil at_stress(const MacroscopicSoil& soil, Range tested, double stress);

/// Normal stresses of the test that the state's strength is from [Pa]; nothing where it does not say them.
std::optional<Range> tested_stresses(const SoilState& state);

/// Cohesion of fine-grained soil that shows this cone index at this friction angle: the inverse of cone_index() [Pa].
/// Throws InputError where friction and overburden alone show more.
double cohesion_of_cone(double index, double friction_angle);

}  // namespace gonogo::terrain
