// A family of wheels: numbers without dimension that describe a wheel under its load, and the canonical wheel that has
// them at a given size and gravity.
//
// Granular flow under a wheel scales: of wheels of one shape, the power over M g sqrt(g L) and the speed over sqrt(g L)
// depend only on g / (L w^2), rho D L^2 / M and, with cohesion, c / (rho g L), where L is the size, D the width, M the
// load's mass and w the speed of rotation (Slonaker, Motley, Zhang, Townsend, Senatore, Iagnemma & Kamrin, "General
// scaling relations for locomotion in granular media", Phys. Rev. E 95 (2017) 052901). So neither size nor gravity
// needs to be sampled.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

/// Bulk density of soil that numbers without dimension are based on [kg/m^3]: that of grains of 2,650 kg/m^3 at a solid
/// fraction of 0.604, which is within 5 % of every packing of the soil tables.
inline constexpr double kFamilyDensity = 1600;

/// Below this share of the diameter a tyre counts as rigid, and a wheel as smooth.
inline constexpr double kNegligible = 0.005;

/// A wheel of diameter D without lugs and width b, under a load W.
struct WheelNumbers {
  double load = 0;        // W / (rho g b D^2): Slonaker's M / (rho D L^2), divided by 4 because L is the radius
  double width = 0;       // b / D
  double deflection = 0;  // static deflection on hard ground over D; 0: rigid
  double lug = 0;         // height of lugs over D; 0: smooth
};

/// Of a wheel under a load [N].
WheelNumbers wheel_numbers(const Wheel& wheel, double load, double gravity);

/// What all members of a family share, as configs/families/wheeled.json says it.
struct Family {
  std::string name, about;
  std::vector<std::string> sources;
  double diameter = 1;                   // of the canonical wheel [m]
  int lug_count = 0;                     // of wheels with lugs
  double lug_thickness = 0;              // over the diameter
  double friction = 0;                   // coefficient of the tread on hard ground
  std::map<std::string, Range> range;    // of the numbers, by the name of their variable in the contract
  double wheel_mass = 0, spring_hz = 0;  // share of the load's mass; natural frequency on the Earth at 1 m [Hz]
};

/// Throws InputError for anything missing or out of range.
Family read_family(const Config& c);
bool is_family(const Config& c);

/// Factors from the size and gravity that a family is driven at to those of a member with equal numbers. Soil has one
/// density at both, so that a cohesion number c / (rho g D) makes cohesions scale by `stress`.
struct MemberScale {
  double length = 1;  // D / D_f
  double speed = 1;   // sqrt(g D / (g_f D_f)): equal v / sqrt(g D)
  double stress = 1;  // g D / (g_f D_f)
  double time() const { return length / speed; }
};

/// Of a member with wheels of this diameter [m] at this gravity, of a family driven at `family_gravity` [m/s^2].
MemberScale member_scale(const Family& family, double family_gravity, double diameter, double gravity);

/// The load that a wheel of these numbers has at the family's size [N].
double load_of(const Family& family, const WheelNumbers& numbers, double gravity);

/// The family's wheel of these numbers as a quarter vehicle: its load is the weight of wheel and sprung mass. Speeds of
/// its spring scale by sqrt(g / D), so that it swings alike at every size and gravity.
Vehicle canonical_wheel(const Family& family, const WheelNumbers& numbers, double gravity);

}  // namespace gonogo::vehicle
