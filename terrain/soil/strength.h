// What a strength was measured by, and what other tests of the same soil show.
//
// One soil has several friction angles. Triaxial compression shows phi_t of Mohr and Coulomb. A shear box, a shear ring
// or a bevameter shows tan(phi_s) = tau / sigma on the plane of shear. With a dilation angle psi of the soil,
//
//   tan(phi_s) = sin(phi_t) cos(psi) / (1 - sin(phi_t) sin(psi)),   c_s = c cos(phi_t) cos(psi) / (1 - sin(phi_t)
//   sin(psi))
//
// since a plane of simple shear does not lengthen (Davis 1968, "Theories of plasticity and the failure of soil masses",
// in Soil Mechanics, Selected Topics, ed. Lee). So 32 degrees on the plane are 38.7 in triaxial compression without
// dilation. Formulas for wheels, tracks and plates take the angle on the plane of shear.
#pragma once
#include <string>
#include <vector>

namespace gonogo::terrain {

/// Tests that show a friction angle come first.
enum class StrengthTest { triaxial, direct_shear, ring_shear, plane_strain, repose, unconfined, plate, cone };

const std::vector<std::string>& strength_test_names();
std::string name_of(StrengthTest test);
StrengthTest strength_test_of(const std::string& name);

/// Where on the curve of a test an angle is read.
enum class Stage { peak, residual };

/// What a friction angle and its cohesion mean. The dilation angle is the soil's at that stage [deg].
struct AngleMeaning {
  StrengthTest test = StrengthTest::triaxial;
  Stage stage = Stage::peak;
  double dilation = 0;
  bool assumed = false;  // nobody named the test

  /// Whether the angle is what calibration tables and models take.
  bool is_triaxial_peak() const { return test == StrengthTest::triaxial && stage == Stage::peak; }
  /// Whether the angle is tau / sigma on a plane of shear.
  bool is_on_plane() const { return test == StrengthTest::direct_shear || test == StrengthTest::ring_shear; }
  /// "direct shear, peak"
  std::string text() const;
};

/// phi_s from phi_t [deg].
double angle_on_plane(double triaxial, double dilation = 0);
/// phi_t from phi_s [deg]. Throws InputError for angles that no soil has: tan(phi_s) >= cos(psi) / (1 - sin(psi)).
double angle_of_triaxial(double on_plane, double dilation = 0);
/// c_s / c at this phi_t [-].
double cohesion_on_plane(double triaxial, double dilation = 0);

/// Plane strain shows 9 / 8 of the triaxial angle (Wroth 1984, "The interpretation of in situ soil tests", Geotechnique
/// 34, 449-489).
inline constexpr double kPlaneStrainRatio = 9.0 / 8.0;

/// Cohesion of a soil that breaks under this stress without lateral support: q_u / 2 tan(45 - phi_t / 2).
double cohesion_of_unconfined(double strength, double triaxial);

/// What an angle without a test means, by each reading: "as triaxial compression it is 32 deg, as direct or ring shear
/// 38.7 deg of triaxial compression, as plane strain 28.4 deg".
std::string readings_of(double angle);

}  // namespace gonogo::terrain
