#include "pipeline/map/rivals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/units.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/campaign/study/contract.h"
#include "terrain/soil/soil.h"
#include "vehicle/family/common_pull.h"
#include "vehicle/family/vehicle_numbers.h"
#include "vehicle/semi_empirical/bekker_wong.h"
#include "vehicle/semi_empirical/mobility_index.h"
#include "vehicle/semi_empirical/traction.h"

namespace gonogo::map {
namespace {

constexpr double kAspect = 0.75, kUsualDeflection = 0.15;  // of a tyre's section: height over width

/// A vehicle of the family on a trial's soil and slope.
struct Asked {
  vehicle::VehicleNumbers numbers;
  double grade = 0, slope = 0, speed = 0;             // tan(slope); [rad]; over sqrt(g D)
  double friction_angle = 0, cohesion = 0, cone = 0;  // [rad], [Pa], [Pa]
  double diameter = 1, weight = 0;                    // [m], [N]
};

Asked asked_at(std::span<const double> point, double diameter) {
  const auto value = [&](const char* name) { return point[campaign::contract().variable_index(name)]; };
  Asked a{.numbers = campaign::vehicle_at({.variables = {point.begin(), point.end()}})};
  a.diameter = diameter;
  a.slope = to_radians(value("slope_along"));
  a.grade = std::tan(a.slope);
  a.speed = value("commanded_speed") / std::sqrt(kGravity * a.diameter);
  a.friction_angle = to_radians(value("friction_angle"));
  a.cohesion = 1e3 * value("cohesion");
  a.cone = terrain::cone_index(a.cohesion, value("friction_angle"));
  const vehicle::WheelNumbers& w = a.numbers.wheel;
  a.weight = 2 * a.numbers.axles * w.load * vehicle::kFamilyDensity * kGravity * w.width * std::pow(a.diameter, 3);
  return a;
}

/// axle_load: over that of equally loaded axles.
vehicle::WheelOnSoil wheel_on_soil(const Asked& a, double axle_load) {
  const vehicle::WheelNumbers& w = a.numbers.wheel;
  const double width = w.width * a.diameter, height = kAspect * width;
  const bool rigid = w.deflection < vehicle::kNegligible;
  return {.load = axle_load * a.weight / (2 * a.numbers.axles),
          .diameter = a.diameter,
          .width = width,
          .section_height = height,
          .deflection = std::min(rigid ? kUsualDeflection * height : w.deflection * a.diameter, 0.9 * height),
          .cone_index = a.cone};
}

/// Largest sum of the wheels' pulls over the weight, all wheels at one slip, within what the driveline gives. The
/// relations say nothing of side forces.
double best_pull(const Asked& a, const std::function<double(const vehicle::WheelOnSoil&, double slip)>& pull) {
  constexpr std::array kSlips = {0.1, 0.2, 0.4, 0.7};
  const std::vector<double> shares = vehicle::axle_shares(a.numbers, a.slope), loads = vehicle::axle_loads(shares);
  const auto forces = [&](std::size_t axle, std::size_t k) {
    return vehicle::AxleForces{.pull = pull(wheel_on_soil(a, loads[axle]), kSlips[k])};
  };
  const double best = vehicle::largest_pull(shares, kSlips.size(), 0, forces).pull;
  return std::min(best, vehicle::drive_force(a.numbers, a.speed));
}

double one_pass_index(const Asked& a) {
  const vehicle::WheelOnSoil wheel = wheel_on_soil(a, 1);
  const vehicle::MobilityFactors factors = vehicle::mobility_factors(vehicle::WheeledIndexInput{
      .axle_load = 2 * wheel.load,
      .diameter = wheel.diameter,
      .section_width = wheel.width,
      .clearance = a.numbers.clearance * a.diameter,
      .power_per_mass = a.numbers.power * std::sqrt(kGravity * a.diameter) * kGravity,
  });
  return vehicle::wheeled_cone_index(factors.index(), wheel.deflection / wheel.section_height).one_pass * kPsi;
}

double cone_index_margin(const Asked& a) {
  if (a.cone < one_pass_index(a)) return -1;
  return best_pull(a, [](const auto& wheel, double slip) { return vehicle::brixius(wheel, slip, true).net(); }) -
         a.grade;
}

double sand_margin(const Asked& a) {
  return best_pull(a,
                   [](const vehicle::WheelOnSoil& w, double slip) {
                     const double pressure = w.load / (w.width * w.diameter / 2);
                     return vehicle::sand_net_traction(std::max(pressure / w.cone_index, vehicle::kMinPressureRatio),
                                                       slip);
                   }) -
         a.grade;
}

double clay_margin(const Asked& a) {
  return best_pull(a, [](const auto& wheel, double slip) { return vehicle::clay_traction(wheel, slip).net(); }) -
         a.grade;
}

double bekker_margin(const Asked& a) {
  const vehicle::BekkerSoil soil{.n = 1.1,
                                 .k_c = 0.99e3,
                                 .k_phi = 1528.43e3,
                                 .cohesion = a.cohesion,
                                 .friction_angle = a.friction_angle,
                                 .shear_modulus = 0.025};
  const vehicle::RigidWheel wheel{.radius = a.diameter / 2,
                                  .width = a.numbers.wheel.width * a.diameter,
                                  .lug_height = a.numbers.wheel.lug * a.diameter};
  try {
    return best_pull(a,
                     [&](const vehicle::WheelOnSoil& w, double slip) {
                       return vehicle::wheel_forces_under(soil, wheel, {.slip = slip}, w.load).drawbar_pull / w.load;
                     }) -
           a.grade;
  } catch (const InputError&) {
    return -1;  // sinks to its axles
  }
}

}  // namespace

const std::vector<std::string>& rival_names() {
  static const std::vector<std::string> names = {"cone_index", "drove_sand", "drove_clay", "bekker_wong"};
  return names;
}

std::vector<double> rival_margins(std::span<const double> point, double diameter) {
  const Asked a = asked_at(point, diameter);
  return {cone_index_margin(a), sand_margin(a), clay_margin(a), bekker_margin(a)};
}

}  // namespace gonogo::map
