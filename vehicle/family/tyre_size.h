// Tyre sizes as they stand on sidewalls and data sheets: dimensions, load limit and stiffness.
#pragma once
#include <optional>
#include <string>

namespace gonogo::vehicle {

/// Damping of a tyre under its load, over the critical one, as in hmmwv.json.
inline constexpr double kTyreDamping = 0.05;

struct TyreSize {
  std::string text;          // as given
  double diameter = 0;       // unloaded, over the tread [m]
  double section_width = 0;  // [m]
  double rim = 0;            // diameter of the seat [m]; 0: a wheel without a tyre
  bool light_duty = false;   // of an ATV, by its rim of at most 14 inches and its shape
  bool truck = false;        // a size of trucks: the width alone is named, or the section is over 0.3 m wide
  std::string rule;          // how the dimensions follow from the text
  bool pneumatic() const { return rim > 0; }
  double section_height() const { return (diameter - rim) / 2; }
};

/// Reads
///   37x12.50R16.5, 25x8-12      diameter x section width, rim, in inches
///   395/85R20, LT285/70R17      section width in millimetres / aspect ratio in per cent, rim in inches
///   16.00R20, 7.50-16           section width, rim, in inches
///   0.5x0.2                     a wheel without a tyre: diameter x width in metres
/// Throws InputError for any other text, and for sizes that no tyre has.
TyreSize read_tyre_size(const std::string& text);

/// A wheel without a tyre, diameter and width in metres.
TyreSize bare_wheel(double diameter, double width);

/// Largest load of a tyre at an inflation pressure [N, Pa], by the load formula of the Tire and Rim Association,
///   L = 6.67e-5 P^(1/2) S_d^1.39 (D_r + S_d) kg,  S_d = (0.34848 + 0.6497 A) S,
/// P in kPa, S section width and D_r rim diameter in mm, A height over width of the section (eng-tips.com, FAQ
/// 108-1148). It was made for passenger tyres; tyres of light trucks and ATVs are rated lower at the same pressure.
double load_limit(const TyreSize& tyre, double pressure);

/// Largest cold inflation that tyres of such a size are made for [Pa]: 150 kPa for ATVs, 550 kPa (80 psi, load range E)
/// for light trucks, 830 kPa (120 psi) for trucks. Sidewalls say the tyre's own.
double largest_inflation(const TyreSize& tyre);

/// Load of a load index, 0 to 200 [kg]: 1, 1.25, 1.6, ... steps of 80 to a factor of ten (ETRTO: LI 91 is 615 kg).
double load_of_index(int load_index);

/// Vertical stiffness of a belted radial tyre at an inflation pressure [N/m, Pa]:
///   K = 0.00028 P sqrt((1.03 - 0.004 a) S (S a / 50 + D_r)) + 3.45 kgf/mm,
/// P in kPa, S and D_r in mm, a the aspect ratio in per cent (T. B. Rhyne, "Development of a vertical stiffness
/// relationship for belted radial tires", Tire Science and Technology 33 (2005) 136-155).
double radial_stiffness(const TyreSize& tyre, double pressure);

}  // namespace gonogo::vehicle
