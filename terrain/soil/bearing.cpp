#include "terrain/soil/bearing.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/format.h"
#include "base/units.h"

namespace gonogo::terrain {
namespace {

constexpr double kSinkages[] = {0.02, 0.05, 0.1};  // [m]
constexpr double kUsualWidth = 0.1;                // [m]
constexpr double kFormulaError = 0.15;             // of the logarithm of a bearing capacity
constexpr double kMisses = 2;                      // errors

/// Factor of the weight beside and below a plate.
double weight_factor(double friction_angle) {
  return 1.5 * (surcharge_factor(friction_angle) - 1) * std::tan(to_radians(friction_angle));
}

double most(const MacroscopicSoil& s, double unit_weight, double b, double depth) {
  const double phi = to_radians(s.friction_angle), side = 2 * b,
               of_cohesion = bearing_capacity_factor(s.friction_angle),
               of_surcharge = surcharge_factor(s.friction_angle), shape = 1 + of_surcharge / of_cohesion,
               lever = std::tan(phi) * std::pow(1 - std::sin(phi), 2);
  return s.cohesion * of_cohesion * shape * (1 + 0.4 * depth / side) +
         unit_weight * depth * of_surcharge * shape * (1 + 2 * lever * depth / side) +
         unit_weight * side / 2 * weight_factor(s.friction_angle);
}

double least(const MacroscopicSoil& s, double unit_weight, double b, double depth) {
  constexpr double kLocal = 2.0 / 3;
  const double angle = to_degrees(std::atan(kLocal * std::tan(to_radians(angle_on_plane(s.friction_angle)))));
  return kLocal * cohesion_on_plane(s.friction_angle) * s.cohesion * bearing_capacity_factor(angle) +
         unit_weight * depth * surcharge_factor(angle) + unit_weight * b / 2 * weight_factor(angle) / 2;
}

double half_width(const SoilValue& v, double alone) {
  return v.fixed() ? alone : (v.high - v.low) / 2 / std::sqrt(3.0);
}

/// The state's strength in triaxial compression, with its angle and cohesion moved by this much.
MacroscopicSoil moved(const Calibration* table, const SoilState& state, double angle, double cohesion) {
  constexpr double kSteepestPlane = 44.9;  // formulas have no triaxial angle beyond it [deg]
  MacroscopicSoil s = state.macroscopic();
  s.friction_angle = std::max(0.0, s.friction_angle + angle);
  if (s.meaning.is_on_plane()) s.friction_angle = std::min(s.friction_angle, kSteepestPlane);
  s.cohesion = std::max(0.0, s.cohesion + cohesion);
  return table ? as_triaxial(*table, s) : as_triaxial(s);
}

/// A plate's pressure at a sinkage, beside the range that its soil may show.
struct Comparison {
  double depth, pressure;  // [m], [Pa]
  BearingRange range;
  double deviation;  // errors above the most; below zero, under the least; 0: inside
};

Comparison compare(const Calibration* table, const SoilState& state, double width, double depth) {
  const Bekker& b = *state.bekker;
  const double unit_weight = state.bulk_density.middle() * kGravity;
  const double modulus = b.k_c.middle() / width + b.k_phi.middle();
  const double pressure = 1e3 * modulus * std::pow(depth, b.n.middle());
  const double angle_error = half_width(state.friction_angle, 1),
               cohesion_error = 1e3 * half_width(state.cohesion, 0.1 * state.cohesion.middle());
  const auto at = [&](double angle, double cohesion) {
    return bearing_range(moved(table, state, angle, cohesion), unit_weight, width, depth);
  };
  const BearingRange range = at(0, 0), by_angle = at(angle_error, 0), by_cohesion = at(0, cohesion_error);
  const double of_plates = half_width(b.k_phi, 0.1 * b.k_phi.middle()) / std::max(1e-9, std::abs(b.k_phi.middle()));
  const auto error = [&](double BearingRange::*end) {
    return std::sqrt(kFormulaError * kFormulaError + of_plates * of_plates +
                     std::pow(std::log(by_angle.*end / range.*end), 2) +
                     std::pow(std::log(by_cohesion.*end / range.*end), 2));
  };
  double deviation = 0;
  if (pressure > range.most) deviation = std::log(pressure / range.most) / error(&BearingRange::most);
  if (pressure < range.least)
    deviation = -std::log(range.least / std::max(1.0, pressure)) / error(&BearingRange::least);
  return {depth, pressure, range, deviation};
}

}  // namespace

BearingRange bearing_range(const MacroscopicSoil& soil, double unit_weight, double width, double depth) {
  return {least(soil, unit_weight, width, depth), most(soil, unit_weight, width, depth)};
}

std::optional<std::string> plates_against_strength(const SoilState& state, const Calibration* table) {
  if (!state.bekker || !(state.bulk_density.middle() > 0)) return std::nullopt;
  std::vector<double> widths;
  for (const SoilTest& t : state.tests) widths.insert(widths.end(), t.plate_widths.begin(), t.plate_widths.end());
  if (widths.empty()) widths = {kUsualWidth};
  std::optional<Comparison> worst;
  for (const double width : widths)
    for (const double depth : kSinkages) {
      const Comparison found = compare(table, state, width, depth);
      if (!worst || std::abs(found.deviation) > std::abs(worst->deviation)) worst = found;
    }
  if (std::abs(worst->deviation) <= kMisses) return std::nullopt;
  const bool above = worst->deviation > 0;
  return line(
      "plates and shear contradict each other by limit analysis: %.3g m deep the plates carry %.4g kPa, and soil of "
      "%.3g deg and %.3g kPa by %s carries %s %.4g kPa; %s",
      worst->depth, worst->pressure / 1e3, state.friction_angle.middle(), state.cohesion.middle(),
      state.meaning.text().c_str(), above ? "at most" : "at least",
      (above ? worst->range.most : worst->range.least) / 1e3,
      above ? "measure the shear again, or take the plates to have met a firmer layer"
            : "measure the plates again, or take the soil to be crushed under them");
}

}  // namespace gonogo::terrain
