#include "vehicle/semi_empirical/mobility_index.h"

#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

constexpr double kHorsepower = 745.7, kShortTon = 907.18474;  // [W], [kg]
constexpr double kUsualDeflection = 0.15;                     // at which the correction is 1

/// 1.05 below 10 hp per short ton.
double engine_factor(double power_per_mass) { return power_per_mass * kShortTon / kHorsepower < 10 ? 1.05 : 1; }

/// Weight factor of wheels, axle load in pounds.
double axle_weight_factor(double pounds) {
  const double kips = pounds / 1000;
  if (pounds < 2000) return 0.553 * kips;
  if (pounds < 13500) return 0.033 * kips + 1.05;
  if (pounds < 20000) return 0.142 * kips - 0.42;
  return 0.278 * kips - 3.115;
}

double track_weight_factor(double pounds) {
  if (pounds < 50000) return 1;
  if (pounds < 70000) return 1.2;
  return pounds < 100000 ? 1.4 : 1.8;
}

VehicleIndex tracked_index(const Vehicle& v) {
  const Track& t = *v.track;
  TrackedIndexInput in;
  in.weight = weigh(v).total * kGravity;
  in.ground_length = track_contact_length(v);
  in.width = t.shoe_width;
  in.road_wheels = int(stations(v).size());
  in.shoe_area = t.shoe_width * t.shoe_pitch;
  in.grouser_height = t.grouser_height;
  in.clearance = v.clearance;
  in.power_per_mass = v.power / weigh(v).total;
  in.automatic = v.automatic;
  VehicleIndex result;
  result.factors = mobility_factors(in);
  result.cone_index = tracked_cone_index(result.factors.index());
  return result;
}

VehicleIndex axle_index(const Vehicle& v, std::size_t axle) {
  const Axle& a = v.axle[axle];
  const Wheel& wheel = find_wheel(v, a.wheel);
  if (wheel.size_diameter <= 0)
    throw InputError(v.name + ": wheels." + wheel.name + " has no tyre_size, which the mobility index needs; add it");
  WheeledIndexInput in;
  const double total = weigh(v).total;
  // The index is defined with the mean axle load.
  in.axle_load = total * kGravity / double(v.axle.size());
  in.tyres_per_axle = a.single ? 1 : 2;
  in.diameter = wheel.size_diameter;
  in.section_width = wheel.size_section_width;
  in.clearance = v.clearance;
  in.power_per_mass = v.power / total;
  in.automatic = v.automatic;
  VehicleIndex result{.axle = a.name, .factors = mobility_factors(in), .deflection_given = wheel.size_deflection > 0};
  result.deflection_ratio =
      result.deflection_given ? wheel.size_deflection / wheel.size_section_height : kUsualDeflection;
  result.cone_index = wheeled_cone_index(result.factors.index(), result.deflection_ratio);
  return result;
}

}  // namespace

MobilityFactors mobility_factors(const WheeledIndexInput& in) {
  const double load = in.axle_load / kPoundForce, width = in.section_width / kInch, diameter = in.diameter / kInch;
  MobilityFactors f;
  f.contact_pressure = load / (0.5 * in.tyres_per_axle * diameter * width);
  f.weight = axle_weight_factor(load);
  f.tyre_or_track = (10 + width) / 100;
  f.grouser = in.chains ? 1.05 : 1;
  f.load = load / 1000 / in.tyres_per_axle;
  f.clearance = in.clearance / kInch / 10;
  f.engine = engine_factor(in.power_per_mass);
  f.transmission = in.automatic ? 1 : 1.05;
  return f;
}

MobilityFactors mobility_factors(const TrackedIndexInput& in) {
  const double weight = in.weight / kPoundForce, square_inch = kInch * kInch;
  MobilityFactors f;
  f.contact_pressure = weight / (2 * in.ground_length * in.width / square_inch);
  f.weight = track_weight_factor(weight);
  f.tyre_or_track = in.width / kInch / 100;
  f.grouser = in.grouser_height / kInch > 1.5 ? 1.1 : 1;
  f.load = weight / 10 / (in.road_wheels * in.shoe_area / square_inch);
  f.clearance = in.clearance / kInch / 10;
  f.engine = engine_factor(in.power_per_mass);
  f.transmission = in.automatic ? 1 : 1.05;
  return f;
}

double deflection_correction(double deflection_ratio) { return std::pow(0.15 / deflection_ratio, 0.25); }

VehicleConeIndex wheeled_cone_index(double mobility_index, double deflection_ratio) {
  const double m = mobility_index, correction = deflection_correction(deflection_ratio);
  if (m > 115) return {4.1 * std::pow(m, 0.446) * correction, 9 * std::pow(m, 0.446) * correction};
  return {(11.48 + 0.2 * m - 39.2 / (m + 3.74)) * correction, (28.23 + 0.43 * m - 92.67 / (m + 3.67)) * correction};
}

VehicleConeIndex tracked_cone_index(double mobility_index) {
  const double m = mobility_index;
  return {7 + 0.2 * m - 39.2 / (m + 5.6), 19.27 + 0.43 * m - 125.79 / (m + 7.08)};
}

VehicleIndex vehicle_index(const Vehicle& v) {
  if (v.kind == VehicleKind::single_wheel)
    throw InputError(v.name + ": a mobility index is of a whole vehicle, not of a single-wheel rig");
  if (v.kind == VehicleKind::tracked) return tracked_index(v);
  VehicleIndex worst = axle_index(v, 0);
  for (std::size_t i = 1; i < v.axle.size(); ++i) {
    const VehicleIndex next = axle_index(v, i);
    if (next.cone_index.one_pass > worst.cone_index.one_pass) worst = next;
  }
  return worst;
}

}  // namespace gonogo::vehicle
