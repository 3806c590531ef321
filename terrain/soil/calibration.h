// Calibration: from macroscopic soil properties to contact parameters. Virtual triaxial tests over a line of contact
// parameters and the packings of the library give a table of friction angle, cohesion and density. Trials invert it.
//
// The friction angle is the one that a laboratory reports for a soil at its density: Mohr-Coulomb's angle at the peak
// of drained triaxial compression. Tables before version 4 hold the angle of steady simple shear, tan(phi) = tau /
// sigma on the plane of shear, the same for all densities. On rough grains it is 10 to 25 degrees smaller
// (docs/soils.md).
//
// The angle on the plane of simple shear, tan(phi_s) = tau / sigma, is smaller: without dilation tan(phi_s) =
// sin(phi). Tables from version 6 on hold both.
//
// Relative density depends on the grains. Rough grains settle more loosely than smooth ones, so that one packing may be
// of medium density for rough grains and loose for smooth ones. Tables before version 5 use the same scale for all.
#pragma once
#include <filesystem>
#include <optional>

#include "base/json/config.h"
#include "base/json/json.h"
#include "terrain/bed/bed.h"
#include "terrain/soil/strength.h"

namespace gonogo::terrain {

/// An angle with its standard error [deg].
struct Angle {
  double degrees = 0, error = 0;
};

/// One packing of the library, with its measured density.
struct PackingLevel {
  double settle_friction;   // friction with which it settled
  double solid_fraction;    // [-]
  double relative_density;  // (e_max - e) / (e_max - e_min), e = 1 / solid_fraction - 1, over the library [-]
};
// A soil's relative density is the same formula with e_max of the contact level's own grains (packing_level).

/// One point of the line of contact parameters, with measured means and standard errors over packings and seeds.
struct ContactLevel {
  double friction = 0, rolling_friction = 0;            // [-]
  double friction_angle = 0, friction_angle_error = 0;  // [deg]
  double cohesion_gain = 0, cohesion_gain_error = 0;    // soil cohesion over cohesion pressure of contacts [-]
  double loosest_solid_fraction = 0;  // of a bed that settles with these laws; at most the library's [-]
};

/// Measurements of a contact level in one packing. Tables of version 1 have none.
struct SoilResponse {
  std::size_t contact = 0, packing = 0;                   // levels
  double friction_angle = 0, friction_angle_error = 0;    // at the triaxial peak; 0 before version 4 [deg]
  double steady_friction_angle = 0;                       // after the peak; 0 before version 4 [deg]
  Angle shear_peak, shear_steady;                         // on the plane of shear; 0 before version 6
  double cohesion_gain = 0;                               // [-]
  double sinkage_modulus = 0, sinkage_modulus_error = 0;  // k of p = k z^n, plate four grains wide [N/m^(n+2)]
  double sinkage_exponent = 0;                            // n [-]
  double cone_gradient = 0, cone_gradient_error = 0;      // over the bed's unit weight [-]; 0: no such test
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
  AngleMeaning meaning{};       // of friction angle and cohesion
};

/// The soil in numbers of triaxial compression, peak, as every function below takes it by itself. With a table these
/// are the numbers of grains that show the given ones in the given test, at the packing of the soil's relative density.
/// Beyond the ends of the table's curve they go on in proportion. Where the table has no such curve, or without a
/// table, strength.h converts, and a residual angle or one of repose counts as the peak's. Throws InputError for a test
/// that shows no friction angle.
MacroscopicSoil as_triaxial(const Calibration& calibration, const MacroscopicSoil& soil);
MacroscopicSoil as_triaxial(const MacroscopicSoil& soil);

/// The soil in numbers of the plane of shear, peak, as formulas for wheels take them: the reverse of as_triaxial().
MacroscopicSoil on_shear_plane(const Calibration& calibration, const MacroscopicSoil& soil);
MacroscopicSoil on_shear_plane(const MacroscopicSoil& soil);

/// The packing level whose relative density is nearest to the soil's, for grains with the soil's friction angle in that
/// packing. Relative density is (1 / f_loose - 1 / f) / (1 / f_loose - 1 / f_dense), with solid fractions f of the
/// packing, f_loose of those grains, and f_dense of the library's densest packing. In tables before version 5, f_loose
/// is the library's loosest.
std::size_t packing_level(const Calibration& calibration, const MacroscopicSoil& soil);

/// Contact law with which a bed of this packing has the soil's friction angle and cohesion. Throws InputError that
/// states the reachable range when the table does not cover the soil's angle, or its cohesion (reachable_cohesion).
sim::PairLaw contact_law(const Calibration& calibration, const MacroscopicSoil& soil, std::size_t packing);

/// The best match of a soil by a table: contact law, packing and density of the solid, and the properties of such a bed
/// by the table.
struct SoilFit {
  sim::PairLaw law;
  std::size_t packing = 0;                              // level
  double grain_density = 0;                             // gives the bulk density; quartz if none is asked [kg/m^3]
  double friction_angle = 0, friction_angle_error = 0;  // [deg]
  double cohesion = 0, cohesion_error = 0;              // [Pa]
  double bulk_density = 0, relative_density = 0;        // [kg/m^3], [-]
  double sinkage_modulus = 0, sinkage_exponent = 0;     // not fitted; 0 in tables of version 1
};

/// Throws InputError as contact_law does; for a bulk density that no solid of 1000 to 5000 kg/m^3 gives; and for a
/// cohesion that the table knows only to more than 20 %. The message says how close the table comes.
SoilFit fit_soil(const Calibration& calibration, const MacroscopicSoil& soil);

/// What grains of this triaxial angle show in a packing, by another test [deg]; by formula where the table has no
/// curve.
double shown_angle(const Calibration& calibration, std::size_t packing, double triaxial, const AngleMeaning& meaning);
/// Relative density of a packing for grains of this triaxial angle [-].
double packing_density(const Calibration& calibration, double triaxial, std::size_t packing);

/// Pressure at one grain's depth under a plate four grains wide on quartz grains of this triaxial angle without
/// cohesion [Pa]; 0 where the table does not know.
double plate_pressure(const Calibration& calibration, double triaxial, std::size_t packing);

/// Gradient of the cone index over the unit weight of such grains without cohesion [-]; 0 where the table does not
/// know.
double cone_gradient(const Calibration& calibration, double triaxial, std::size_t packing);

/// Friction angles that the table reaches [deg]: in every packing, or in one.
struct AngleRange {
  double lowest, highest;
};
AngleRange reachable_angles(const Calibration& calibration);
AngleRange reachable_angles(const Calibration& calibration, std::size_t packing);

/// Largest cohesion [Pa] that the table serves at a friction angle in a packing. Tests measure cohesion as a share of
/// the contacts' cohesion pressure, at pressures up to the confining stress. The share holds up to kMaxCohesionRatio
/// times the stress; beyond, rough grains move in lumps (docs/soils.md, "How far cohesion goes"). The stress of a trial
/// is kWheelStress. Throws InputError for angles out of reach.
double reachable_cohesion(const Calibration& calibration, double friction_angle, std::size_t packing);

/// Max pressure of the plates behind a table's sinkage moduli [Pa].
inline constexpr double kMaxPlatePressure = 3e6;
/// Mean normal stress under an HMMWV's wheel [Pa]. 6.3 to 10 kN, depending on payload, act on 0.254 m times 0.29 m, the
/// chord of a wheel of radius 0.467 m at 0.1 m sinkage: 86 to 136 kPa.
inline constexpr double kWheelStress = 110e3;
/// Max of the contacts' cohesion pressure over that stress [-].
inline constexpr double kMaxCohesionRatio = 2;

void write_calibration(const std::filesystem::path& path, const Calibration& calibration);
Calibration read_calibration(const std::filesystem::path& path);
Calibration read_calibration(const Config& file);

/// Numerics that the user gave; the others come from the table.
struct AskedNumerics {
  std::optional<double> step;  // [s]
  std::optional<int> substeps, iterations;
  std::optional<double> tolerance;  // [m/s]
  std::optional<sim::Target> target;
  std::optional<sim::ContactLaw> contact{};  // complementarity or a penalty law
  std::optional<double> overlap{};           // of a penalty law, see Numerics
  std::optional<double> give{};              // of contacts, see Numerics

  /// Whether the user gave all that every table states.
  bool complete() const { return step && substeps && iterations && tolerance && target; }
};

/// Numerics in the table's provenance, with those that the user gave in their place. A friction angle holds only for
/// the numerics of its measurement (docs/soils.md). Throws InputError when the table does not state its numerics and
/// the user did not give all; the message names the table `file`.
Numerics numerics_by_table(const Calibration& table, const std::filesystem::path& file,
                           const AskedNumerics& asked = {});

}  // namespace gonogo::terrain
