#include "pipeline/map/family_member.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/format.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/campaign/study/contract.h"
#include "vehicle/family/driveline_share.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/engine_vehicle.h"

namespace gonogo::map {
namespace {

std::size_t index(const char* name) { return campaign::contract().variable_index(name); }

/// A variable of the contract that a member has at another scale than the family.
struct ScaledVariable {
  std::size_t variable;
  double factor;  // member over family
};

std::array<ScaledVariable, 3> scaled_variables(const FamilyMember& m) {
  return {{{index("cohesion"), m.scale.stress},
           {index("bed_depth"), m.scale.length},
           {index("commanded_speed"), m.scale.speed}}};
}

using SlopeOf = double(const vehicle::Vehicle&, const vehicle::VehicleNumbers&, double);

/// Changes a slope along the member [deg]. What is equal or not known stays so to the last digit.
double changed(const FamilyMember& m, double slope, SlopeOf change) {
  const double before = to_radians(slope), after = change(m.vehicle, m.numbers, before);
  return after == before || std::isnan(after) ? slope : to_degrees(after);
}
double felt(const FamilyMember& m, double slope) { return changed(m, slope, vehicle::felt_slope); }
double unfelt(const FamilyMember& m, double slope) { return changed(m, slope, vehicle::own_slope); }

/// Numbers that the mass changes, by loaded().
void add_load(std::vector<double>& point, double mass_ratio) {
  for (const char* name : {"load_number", "deflection_ratio"}) point[index(name)] *= mass_ratio;
  for (const char* name : {"force_number", "power_number"}) point[index(name)] /= mass_ratio;
}

/// Largest payload over the mass, no more than `share`, that keeps the numbers within the box.
double largest_payload(const std::vector<Range>& sampled, const FamilyMember& m, double share) {
  const auto keep = [&](double mass_ratio) {
    if (mass_ratio >= 1) share = std::min(share, mass_ratio - 1);
  };
  keep(sampled[index("load_number")].maximum / m.numbers.wheel.load);
  if (m.numbers.wheel.deflection > 0) keep(sampled[index("deflection_ratio")].maximum / m.numbers.wheel.deflection);
  if (sampled[index("force_number")].minimum > 0) keep(m.numbers.force / sampled[index("force_number")].minimum);
  if (sampled[index("power_number")].minimum > 0) keep(m.numbers.power / sampled[index("power_number")].minimum);
  return share;
}

/// The numbers that are variables of the contract, with what was sampled; trials command the speed.
std::vector<vehicle::PlacedNumber> numbers_of(const FamilyMember& m, const std::vector<Range>& sampled) {
  std::vector<vehicle::PlacedNumber> list = vehicle::placed(m.family, m.numbers);
  std::erase_if(list, [](const vehicle::PlacedNumber& n) { return n.name == "top_speed_number"; });
  for (vehicle::PlacedNumber& n : list) {
    n.range = sampled[index(n.name.c_str())];
    n.value = vehicle::counted(n);
  }
  return list;
}

/// What a measure of the family's vehicle becomes.
struct MeasureScale {
  double weight = 1;  // the member's over that of the trial's vehicle
  double torque = 1;  // of a wheel, at equal push over weight
};

MeasureScale measure_scale(const FamilyMember& m, const campaign::DesignPoint& point) {
  const vehicle::VehicleNumbers driven = campaign::vehicle_at(point);
  const double wheels = 2 * driven.axles;
  double own_wheels = 0;
  for (const vehicle::RunningPart& part : vehicle::running_parts(m.vehicle)) own_wheels += part.driven;
  const double weight = m.mass * m.gravity / (wheels * vehicle::load_of(m.family, driven.wheel, m.family_gravity));
  const double radius = vehicle::drive_radius(m.vehicle) / (m.family.diameter / 2);
  return {.weight = weight, .torque = weight * radius * wheels / own_wheels};
}

campaign::TrialRecord record_of_member(const FamilyMember& m, campaign::TrialRecord record) {
  const MeasureScale s = measure_scale(m, record.point);
  for (const ScaledVariable& v : scaled_variables(m)) record.point.variables[v.variable] *= v.factor;
  double& slope = record.point.variables[index("slope_along")];
  slope = unfelt(m, slope);
  const auto scale = [&](const char* name, double factor) {
    record.measures[campaign::contract().measure_index(name)] *= factor;
  };
  for (const char* name : {"distance", "sinkage", "drift"}) scale(name, m.scale.length);
  for (const char* name : {"mean_speed", "bed_creep", "worst_residual"}) scale(name, m.scale.speed);
  scale("drive_time", m.scale.time());
  scale("mean_torque", s.torque);
  scale("energy_per_metre", s.weight);
  return record;
}

}  // namespace

FamilyMember family_member(const vehicle::Family& family, double family_gravity, const vehicle::Vehicle& v,
                           double gravity) {
  return {.vehicle = v,
          .family = family,
          .family_gravity = family_gravity,
          .gravity = gravity,
          .numbers = vehicle::vehicle_numbers(v, gravity),
          .scale = vehicle::member_scale(family, family_gravity, 2 * v.wheel.front().radius, gravity),
          .mass = vehicle::weigh(v).total};
}

std::vector<double> family_point(const FamilyMember& m, std::span<const double> point) {
  std::vector<double> asked(point.begin(), point.end());
  for (const ScaledVariable& v : scaled_variables(m)) asked[v.variable] /= v.factor;
  double& slope = asked[index("slope_along")];
  slope = felt(m, slope);
  double& payload = asked[index("payload")];
  if (payload > 0) add_load(asked, 1 + payload / m.mass);
  payload = 0;
  return asked;
}

Spreads family_values(const FamilyMember& m, const std::vector<Range>& sampled) {
  Spreads values;
  for (const vehicle::PlacedNumber& n : numbers_of(m, sampled))
    values[n.name] = {Spread::Kind::fixed, n.value, n.value, vehicle_source(m.vehicle.name)};
  return values;
}

std::vector<double> family_points(const FamilyMember& m, const Spreads& values, std::span<const double> points) {
  const std::size_t width = campaign::contract().variables.size();
  std::vector<double> result;
  result.reserve(points.size());
  for (std::size_t first = 0; first < points.size(); first += width) {
    std::vector<double> point(points.begin() + std::ptrdiff_t(first), points.begin() + std::ptrdiff_t(first + width));
    for (const auto& [name, spread] : values) point[index(name.c_str())] = spread.low;
    point = family_point(m, point);
    result.insert(result.end(), point.begin(), point.end());
  }
  return result;
}

std::vector<double> felt_slopes(const FamilyMember& m, std::span<const double> slopes) {
  std::vector<double> result;
  for (const double slope : slopes) result.push_back(felt(m, slope));
  return result;
}

std::vector<Range> member_box(const FamilyMember& m, std::vector<Range> sampled, double most_payload) {
  const double payload = largest_payload(sampled, m, most_payload) * m.mass;
  for (const ScaledVariable& v : scaled_variables(m)) {
    sampled[v.variable].minimum *= v.factor;
    sampled[v.variable].maximum *= v.factor;
  }
  sampled[index("payload")] = {0, payload};
  return sampled;
}

campaign::Dataset trials_of_member(const campaign::Dataset& family, const FamilyMember& member) {
  campaign::Dataset own{.records = {}, .provenance = family.provenance};
  own.records.reserve(family.records.size());
  for (const campaign::TrialRecord& record : family.records) own.records.push_back(record_of_member(member, record));
  return own;
}

campaign::Dataset trials_in_family(const campaign::Dataset& own, const FamilyMember& member,
                                   const std::vector<Range>& sampled) {
  const Spreads values = family_values(member, sampled);
  campaign::Dataset result = own;
  for (campaign::TrialRecord& record : result.records)
    record.point.variables = family_points(member, values, record.point.variables);
  return result;
}

std::vector<std::string> numbers_outside(const FamilyMember& m, const std::vector<Range>& sampled) {
  std::vector<std::string> outside;
  for (const vehicle::PlacedNumber& n : numbers_of(m, sampled))
    if (vehicle::excess(n) > 0)
      outside.push_back(n.name + line(" %.3g (", n.value) + vehicle::place_text(n) +
                        line(" %.3g to %.3g)", n.range.minimum, n.range.maximum));
  return outside;
}

}  // namespace gonogo::map
