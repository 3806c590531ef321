#include "terrain/soil/calibration.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"

namespace gonogo::terrain {

namespace {

/// Whether friction angles are those of triaxial tests, which depend on the packing.
bool knows_packings(const Calibration& c) { return !c.response.empty() && c.response.back().friction_angle > 0; }

double friction_angle(const Calibration& c, std::size_t level, std::size_t packing) {
  return knows_packings(c) ? c.response[level * c.packing.size() + packing].friction_angle
                           : c.contact[level].friction_angle;
}

}  // namespace

AngleRange reachable_angles(const Calibration& c, std::size_t packing) {
  return {friction_angle(c, 0, packing), friction_angle(c, c.contact.size() - 1, packing)};
}

AngleRange reachable_angles(const Calibration& c) {
  AngleRange reach = reachable_angles(c, 0);
  for (std::size_t p = 1; p < c.packing.size(); ++p) {
    const AngleRange r = reachable_angles(c, p);
    reach = {std::max(reach.lowest, r.lowest), std::min(reach.highest, r.highest)};
  }
  return reach;
}

namespace {

/// Where a friction angle lies on the line of contact levels: between `level` - 1 and `level`.
struct PlaceOnLine {
  std::size_t level;
  double share;
  double between(double low, double high) const { return (1 - share) * low + share * high; }
};

/// The nearest end of the line for angles beyond it.
PlaceOnLine nearest_place(const Calibration& c, double angle, std::size_t packing) {
  std::size_t k = 1;
  while (k + 1 < c.contact.size() && friction_angle(c, k, packing) < angle) ++k;
  const double low = friction_angle(c, k - 1, packing), high = friction_angle(c, k, packing);
  return {k, std::clamp((angle - low) / std::max(1e-9, high - low), 0.0, 1.0)};
}

/// Of a packing, for the grains of a place on the line.
double relative_density(const Calibration& c, const PlaceOnLine& at, std::size_t packing) {
  const double loosest =
      at.between(c.contact[at.level - 1].loosest_solid_fraction, c.contact[at.level].loosest_solid_fraction);
  if (!(loosest > 0)) return c.packing[packing].relative_density;
  return (1 / loosest - 1 / c.packing[packing].solid_fraction) / (1 / loosest - 1 / c.packing.back().solid_fraction);
}

PlaceOnLine place_on_line(const Calibration& c, double angle, std::size_t packing) {
  const AngleRange range = reachable_angles(c, packing);
  const PlaceOnLine at = nearest_place(c, angle, packing);
  if (angle >= range.lowest && angle <= range.highest) return at;
  std::ostringstream text;
  text << "soil: friction angle " << angle << " deg is outside what grains of " << c.grain_diameter << " m reach";
  if (knows_packings(c)) text << " at relative density " << relative_density(c, at, packing);
  text << "; choose one between " << range.lowest << " and " << range.highest << " deg";
  throw InputError(text.str());
}

/// Cohesion per contact cohesion pressure: along the line where the table has it for each level, else pooled.
double gain_at(const Calibration& c, const PlaceOnLine& at) {
  if (c.response.empty()) return c.cohesion_gain;
  return at.between(c.contact[at.level - 1].cohesion_gain, c.contact[at.level].cohesion_gain);
}

double gain_error_at(const Calibration& c, const PlaceOnLine& at) {
  if (c.response.empty()) return c.cohesion_gain_error;
  return at.between(c.contact[at.level - 1].cohesion_gain_error, c.contact[at.level].cohesion_gain_error);
}

constexpr double kQuartz = 2650;                                // [kg/m^3]
constexpr double kLightestSolid = 1000, kHeaviestSolid = 5000;  // [kg/m^3]
constexpr double kCohesionTolerance = 0.2;

void refuse_density(const Calibration& c, const MacroscopicSoil& soil, double solid_fraction) {
  std::ostringstream text;
  text << "soil: bulk density " << soil.bulk_density << " kg/m3 cannot be reached at relative density "
       << soil.relative_density << ": grains of " << c.grain_diameter << " m fill " << solid_fraction
       << " of the space; choose one between " << kLightestSolid * solid_fraction << " and "
       << kHeaviestSolid * solid_fraction << " kg/m3";
  throw InputError(text.str());
}

void check_cohesion(const Calibration& c, const MacroscopicSoil& soil, const PlaceOnLine& at) {
  const double gain = gain_at(c, at), error = gain_error_at(c, at);
  if (soil.cohesion == 0 || (gain > 0 && error <= kCohesionTolerance * gain)) return;
  std::ostringstream text;
  text << "soil: cohesion " << soil.cohesion << " Pa at friction angle " << soil.friction_angle
       << " deg: the table knows cohesion there to " << (gain > 0 ? 100 * error / gain : 100)
       << " per cent only, 20 are allowed; calibrate with more seeds or choose another friction angle";
  throw InputError(text.str());
}

double max_cohesion(const Calibration& c, const PlaceOnLine& at) {
  return kMaxCohesionRatio * kWheelStress * gain_at(c, at);
}

/// Up to which share of the confining stress the tests went, in words.
std::string tested_ratio(const Calibration& c) {
  const Json* tested =
      c.provenance.is_object() ? c.provenance.find("cohesion_pressure_over_confining_stress") : nullptr;
  if (!tested || tested->items().empty()) return "";
  std::ostringstream text;
  text << "; its tests went to " << tested->items().back().number() << " times";
  return text.str();
}

void check_cohesion_reach(const Calibration& c, const MacroscopicSoil& soil, const PlaceOnLine& at) {
  const double max = max_cohesion(c, at);
  if (soil.cohesion <= max) return;
  std::ostringstream text;
  text << "soil: cohesion " << soil.cohesion << " Pa at friction angle " << soil.friction_angle
       << " deg needs grains of " << c.grain_diameter << " m that pull with "
       << soil.cohesion / gain_at(c, at) / kWheelStress << " times the stress under a wheel (" << kWheelStress
       << " Pa), and the table serves up to " << kMaxCohesionRatio << " times" << tested_ratio(c) << "; choose at most "
       << max << " Pa there, or leave the soil out: maps call it unknown";
  throw InputError(text.str());
}

}  // namespace

std::size_t packing_level(const Calibration& c, const MacroscopicSoil& soil) {
  const auto off = [&](std::size_t p) {
    return std::fabs(relative_density(c, nearest_place(c, soil.friction_angle, p), p) - soil.relative_density);
  };
  std::size_t best = 0;
  for (std::size_t p = 1; p < c.packing.size(); ++p)
    if (off(p) < off(best)) best = p;
  return best;
}

double reachable_cohesion(const Calibration& c, double friction_angle, std::size_t packing) {
  return max_cohesion(c, place_on_line(c, friction_angle, packing));
}

sim::PairLaw contact_law(const Calibration& c, const MacroscopicSoil& soil, std::size_t packing) {
  const PlaceOnLine at = place_on_line(c, soil.friction_angle, packing);
  check_cohesion_reach(c, soil, at);
  const ContactLevel &a = c.contact[at.level - 1], &b = c.contact[at.level];
  return {Real(at.between(a.friction, b.friction)), Real(at.between(a.rolling_friction, b.rolling_friction)),
          Real(soil.cohesion / gain_at(c, at))};
}

SoilFit fit_soil(const Calibration& c, const MacroscopicSoil& soil) {
  SoilFit f;
  f.packing = packing_level(c, soil);
  const PlaceOnLine at = place_on_line(c, soil.friction_angle, f.packing);
  check_cohesion(c, soil, at);
  const ContactLevel &a = c.contact[at.level - 1], &b = c.contact[at.level];
  f.law = contact_law(c, soil, f.packing);
  const PackingLevel& packing = c.packing[f.packing];
  f.relative_density = relative_density(c, at, f.packing);
  f.grain_density = soil.bulk_density > 0 ? soil.bulk_density / packing.solid_fraction : kQuartz;
  if (!(f.grain_density >= kLightestSolid && f.grain_density <= kHeaviestSolid))
    refuse_density(c, soil, packing.solid_fraction);
  f.bulk_density = f.grain_density * packing.solid_fraction;
  f.friction_angle = at.between(friction_angle(c, at.level - 1, f.packing), friction_angle(c, at.level, f.packing));
  f.friction_angle_error = at.between(a.friction_angle_error, b.friction_angle_error);
  f.cohesion = double(f.law.cohesion_pressure) * gain_at(c, at);
  f.cohesion_error = double(f.law.cohesion_pressure) * gain_error_at(c, at);
  if (!c.response.empty()) {
    const SoilResponse& low = c.response[(at.level - 1) * c.packing.size() + f.packing];
    const SoilResponse& high = c.response[at.level * c.packing.size() + f.packing];
    // Rigid grains: pressure goes with the density of the solid, that of the table being quartz.
    f.sinkage_modulus = at.between(low.sinkage_modulus, high.sinkage_modulus) * f.grain_density / kQuartz;
    f.sinkage_exponent = at.between(low.sinkage_exponent, high.sinkage_exponent);
  }
  return f;
}

}  // namespace gonogo::terrain
