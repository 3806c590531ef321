// From macroscopic soil to contact parameters, by measurement: triaxial tests over a line of contact parameters and the
// packings of the library give a table of friction angle, cohesion and density; trials invert it.
//
// A friction angle is what a laboratory reports for a soil at its density: Mohr and Coulomb's angle at the peak of a
// drained triaxial compression. Tables of versions before 4 hold the angle of steady simple shear instead, tan(phi) =
// tau / sigma on the plane of shear, one for all densities; on rough grains it is 10 to 25 degrees less
// (docs/soils.md).
//
// A relative density belongs to grains: rough ones settle more loosely than smooth ones, so that the same packing is of
// medium density for the former and loose for the latter. Tables before version 5 count it alike for all.
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
// The same with e_max of a contact level's own grains is what a soil's relative density means (packing_level).

/// One point of the line of contact parameters and what it measured, mean and standard error over packings and seeds.
struct ContactLevel {
  double friction = 0, rolling_friction = 0;            // [-]
  double friction_angle = 0, friction_angle_error = 0;  // [deg]
  double cohesion_gain = 0, cohesion_gain_error = 0;    // cohesion per contact cohesion pressure [-]
  double loosest_solid_fraction = 0;  // a bed that settles with these laws, or the library's loosest [-]
};

/// What a contact level measured in one packing. Tables of version 1 have none of these.
struct SoilResponse {
  std::size_t contact = 0, packing = 0;                   // levels
  double friction_angle = 0, friction_angle_error = 0;    // at the triaxial peak; 0 in versions before 4 [deg]
  double steady_friction_angle = 0;                       // after it; 0 in versions before 4 [deg]
  double cohesion_gain = 0;                               // [-]
  double sinkage_modulus = 0, sinkage_modulus_error = 0;  // k of p = k z^n, plate four grains wide [N/m^(n+2)]
  double sinkage_exponent = 0;                            // n [-]
};

struct Calibration {
  double grain_diameter;  // of the sphere with a grain's volume [m]
  GrainShape shape = GrainShape::sphere;
  std::vector<PackingLevel> packing;                  // ascending relative density
  std::vector<ContactLevel> contact;                  // ascending strength
  std::vector<SoilResponse> response;                 // [contact][packing], or empty
  double cohesion_gain = 0, cohesion_gain_error = 0;  // pooled over the contact levels [-]
  Json provenance;
};

struct MacroscopicSoil {
  double friction_angle;        // [deg]
  double cohesion;              // [Pa]
  double bulk_density = 0;      // [kg/m^3]; 0: not given
  double relative_density = 0;  // [-]
};

/// The packing level whose relative density comes nearest to the soil's, counted for grains that have its friction
/// angle in that packing: (1 / f_loose - 1 / f) / (1 / f_loose - 1 / f_dense) of solid fractions, f_loose of those
/// grains' contact levels, f_dense the library's densest. In tables before version 5 f_loose is the library's loosest.
std::size_t packing_level(const Calibration& calibration, const MacroscopicSoil& soil);

/// Contact law whose bed of this packing has the soil's friction angle and cohesion. Throws InputError that states the
/// reachable range when the table does not contain the soil, its cohesion (reachable_cohesion) included.
sim::PairLaw contact_law(const Calibration& calibration, const MacroscopicSoil& soil, std::size_t packing);

/// How far grains of the table's size come to a soil: contact law, packing and density of the solid, and what a bed of
/// these measures by the table.
struct SoilFit {
  sim::PairLaw law;
  std::size_t packing = 0;   // level
  double grain_density = 0;  // that gives the bulk density; quartz where none is asked [kg/m^3]
  double friction_angle = 0, friction_angle_error = 0;  // [deg]
  double cohesion = 0, cohesion_error = 0;              // [Pa]
  double bulk_density = 0, relative_density = 0;        // [kg/m^3], [-]
  double sinkage_modulus = 0, sinkage_exponent = 0;     // not asked for: what follows; 0 in tables of version 1
};

/// Throws InputError as contact_law does, and for a bulk density that no solid of 1000 to 5000 kg/m^3 gives in these
/// packings, or a cohesion that the table knows to no better than 20 per cent. The text says how close it comes.
SoilFit fit_soil(const Calibration& calibration, const MacroscopicSoil& soil);

/// Friction angles that the table can reach in all its packings, and in one of them [deg].
struct AngleRange {
  double lowest, highest;
};
AngleRange reachable_angles(const Calibration& calibration);
AngleRange reachable_angles(const Calibration& calibration, std::size_t packing);

/// Largest cohesion [Pa] that is met at a friction angle in a packing. Tests know cohesion as a share of the
/// contacts' cohesion pressure, up to one times the confining stress; without gravity that ratio is all that counts. It
/// holds on to twice the stress, and at more rough grains move in lumps (docs/soils.md, "How far cohesion goes"). The
/// stress is what a wheel presses with, kWheelStress. Throws InputError for angles out of reach.
double reachable_cohesion(const Calibration& calibration, double friction_angle, std::size_t packing);

/// Mean normal stress under an HMMWV's wheel [Pa]: 6.3 to 10 kN, by payload, over 0.254 m times the chord of a wheel of
/// 0.467 m that has sunk 0.1 m (0.29 m) are 86 to 136 kPa.
inline constexpr double kWheelStress = 110e3;
/// Cohesion pressure between grains over that stress, at most [-].
inline constexpr double kMaxCohesionRatio = 2;

void write_calibration(const std::filesystem::path& path, const Calibration& calibration);
Calibration read_calibration(const std::filesystem::path& path);

}  // namespace gonogo::terrain
