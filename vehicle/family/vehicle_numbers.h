// Whole vehicles of the family: numbers without dimension of a vehicle, and the canonical vehicle that has them.
#pragma once
#include "vehicle/family/numbers.h"

namespace gonogo::vehicle {

/// Of a vehicle of weight W with wheels of diameter D. Lengths are over D.
struct VehicleNumbers {
  WheelNumbers wheel;        // of the mean wheel: W over the number of wheels is its load
  int axles = 2;             // 2 to 4
  double axle_gap = 0;       // free length between the wheels of a side, all together
  double track = 0;          // between the middles of left and right wheels
  double centre_height = 0;  // of mass, over hard ground
  double centre_behind = 0;  // of mass, behind the first axle, over the distance of the outer axles
  double clearance = 0;      // belly over the ground
  double force = 0;          // largest tractive force over W
  double power = 0;          // largest power at the treads over W sqrt(g D): Slonaker's P / (M g sqrt(g L))
  double top_speed = 0;      // over sqrt(g D)
};

/// Throws InputError for vehicles on tracks or one wheel, and for one axle or more than four.
VehicleNumbers vehicle_numbers(const Vehicle& v, double gravity);

/// Of the vehicle with `mass_ratio` times its mass, the centre of mass where it was.
VehicleNumbers loaded(VehicleNumbers numbers, double mass_ratio);

/// The family's vehicle of these numbers: evenly spaced axles on wishbones, a motor in every wheel. Its springs scale
/// as those of canonical_wheel(). Throws InputError for numbers that no vehicle has, such as overlapping wheels.
Vehicle canonical_vehicle(const Family& family, const VehicleNumbers& numbers, double gravity);

/// Loads of the axles over the weight, front to rear, on a slope along the vehicle [rad], uphill positive: a rigid
/// vehicle on equal springs. None is negative; their sum is 1.
std::vector<double> axle_shares(const VehicleNumbers& numbers, double slope);

/// Largest tractive force over the weight at a speed over sqrt(g D).
double drive_force(const VehicleNumbers& numbers, double speed);

/// A number with its name, its value and the family's range.
struct PlacedNumber {
  std::string name, about;
  double value = 0;
  Range range;
};
/// All numbers of a vehicle in the family.
std::vector<PlacedNumber> placed(const Family& family, const VehicleNumbers& numbers);

/// The value, or the end of the range where what lies beyond it never hurts: more force, power, clearance or top speed,
/// a lower centre of mass. A family answers for such a vehicle as for one at the end.
double counted(const PlacedNumber& n);

/// How far outside its range a number is, as a share of the nearest end; 0 inside.
double excess(const PlacedNumber& n);
/// "12 % above", or "inside"
std::string place_text(const PlacedNumber& n);

}  // namespace gonogo::vehicle
