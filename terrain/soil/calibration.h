// From macroscopic soil to contact parameters, by measurement: shear tests over a line of contact parameters and the
// packings of the library give a table of friction angle, cohesion and density; trials invert it.
#pragma once
#include <filesystem>

#include "base/json/json.h"
#include "terrain/bed/bed.h"

namespace gonogo::terrain {

/// One packing of the library and what it measured.
struct PackingLevel {
  double settle_friction;   // that made it
  double solid_fraction;    // [-]
  double relative_density;  // (e_max - e) / (e_max - e_min), e = 1 / solid_fraction - 1, over the library [-]
};

/// One point of the line of contact parameters and what it measured, mean and standard error over packings, loads and
/// seeds. The friction angle is that of steady shear, which does not depend on the initial density.
struct ContactLevel {
  double friction, rolling_friction;            // [-]
  double friction_angle, friction_angle_error;  // [deg]
  double cohesion_gain, cohesion_gain_error;    // cohesion per contact cohesion pressure [-]
};

struct Calibration {
  double grain_diameter;                              // [m]
  std::vector<PackingLevel> packing;                  // ascending relative density
  std::vector<ContactLevel> contact;                  // ascending strength
  double cohesion_gain = 0, cohesion_gain_error = 0;  // pooled over the contact levels [-]
  Json provenance;
};

struct MacroscopicSoil {
  double friction_angle;  // [deg]
  double cohesion;        // [Pa]
};

/// Contact law whose bed has this soil's friction angle and cohesion. Throws InputError that states the reachable range
/// when the table does not contain the soil.
sim::PairLaw contact_law(const Calibration& calibration, const MacroscopicSoil& soil);

/// Friction angles that the table can reach [deg].
struct AngleRange {
  double lowest, highest;
};
AngleRange reachable_angles(const Calibration& calibration);

/// The packing level nearest to a relative density.
std::size_t packing_level(const Calibration& calibration, double relative_density);

void write_calibration(const std::filesystem::path& path, const Calibration& calibration);
Calibration read_calibration(const std::filesystem::path& path);

}  // namespace gonogo::terrain
