#include "terrain/soil/evidence.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "base/units.h"
#include "terrain/soil/bearing.h"

namespace gonogo::terrain {
namespace {

constexpr double kAngleError = 1, kShareError = 0.1, kConeError = 0.25;  // [deg], of one value, of the formula
constexpr double kAngleStep = 0.25, kMostCohesion = 100;                 // [deg], [kPa]
constexpr int kCohesionSteps = 120;
/// Of a plate's pressure, as a decimal logarithm: grains miss those of measured soils by a factor of two
/// (docs/validation.md).
constexpr double kPlateError = 0.3;

/// The same of a cone's gradient or of its index in coarse soil: cones of the table are grains wide.
constexpr double kConeGradientError = 0.2;

/// A point of the grid, with what every test would show.
struct Candidate {
  double angle, cohesion;  // triaxial [deg], [kPa]
  std::size_t packing;
  double friction, rolling;
  double log_weight = 0;
};

/// A number that was given, and how a candidate shows it.
struct Clue {
  std::string what;
  double given, error;
  std::function<double(const Candidate&)> shown;
};

double error_of(const SoilValue& value, double alone) {
  return value.fixed() ? alone : (value.high - value.low) / 2 / std::sqrt(3.0);
}

double with_table(double error, double of_table) { return std::hypot(error, of_table); }

void add_envelope(const Calibration& c, const SoilTest& t, std::vector<Clue>& clues) {
  const AngleMeaning meaning = t.meaning;
  const double of_table = c.contact[c.contact.size() / 2].friction_angle_error;
  clues.push_back({meaning.text() + ": friction angle [deg]", t.friction_angle->middle(),
                   with_table(error_of(*t.friction_angle, kAngleError), of_table),
                   [&c, meaning](const Candidate& s) { return shown_angle(c, s.packing, s.angle, meaning); }});
  if (!t.cohesion) return;
  const double middle = t.cohesion->middle();
  clues.push_back({meaning.text() + ": cohesion [kPa]", middle,
                   error_of(*t.cohesion, std::max(0.2, kShareError * middle)), [meaning](const Candidate& s) {
                     return s.cohesion * (meaning.is_on_plane() ? cohesion_on_plane(s.angle, meaning.dilation) : 1);
                   }});
}

/// Of the table's plate at one grain's depth. Cohesion adds what it bears under a strip. Its bed is six plates long and
/// periodic, too short for what strong soil pushes aside: so no candidate shows more than limit analysis allows.
void add_plate(const Calibration& c, const SoilState& state, const Bekker& b, std::vector<Clue>& clues) {
  const double depth = c.grain_diameter, width = 4 * c.grain_diameter;
  const double unit_weight = std::max(1.0, state.bulk_density.middle() * kGravity);
  const double kPa = (b.k_c.middle() / width + b.k_phi.middle()) * std::pow(depth, b.n.middle());
  clues.push_back(
      {"plate: pressure one grain deep [log10 kPa]", std::log10(kPa), kPlateError,
       [&c, unit_weight, depth, width](const Candidate& s) {
         const double grains = plate_pressure(c, s.angle, s.packing) / 1e3;
         const BearingRange may =
             bearing_range({.friction_angle = s.angle, .cohesion = 1e3 * s.cohesion}, unit_weight, width, depth);
         return std::log10(std::min(grains + s.cohesion * bearing_capacity_factor(s.angle), may.most / 1e3));
       }});
}

bool has_cones(const Calibration& c) {
  return std::any_of(c.response.begin(), c.response.end(), [](const auto& r) { return r.cone_gradient > 0; });
}

/// Gradient of the index of cohesionless grains as heavy as the soil [kPa/m]. Packings without cones show no more than
/// the strongest of the table that have some.
std::function<double(const Candidate&)> gradient_of(const Calibration& c, const SoilState& state) {
  double most = 0;
  for (const SoilResponse& r : c.response) most = std::max(most, r.cone_gradient);
  const double unit_weight = state.bulk_density.middle() * kGravity / 1e3;
  return [&c, most, unit_weight](const Candidate& s) {
    const double known = cone_gradient(c, s.angle, s.packing);
    return unit_weight * (known > 0 ? known : most);
  };
}

/// Decimal logarithms of a cone's gradient, and of its index in soil whose index the formula does not give: the
/// gradient at the middle of its depths, with what cohesion bears under a round base (De Beer's shape factor).
void add_cone(const Calibration& c, const SoilState& state, const SoilTest& t, std::vector<Clue>& clues) {
  const auto gradient = gradient_of(c, state);
  const auto add = [&](const char* what, const SoilValue& value, std::function<double(const Candidate&)> shown) {
    const double middle = std::max(1e-3, value.middle());
    const double error = error_of(value, kShareError * middle) / middle / std::log(10.0);
    clues.push_back({what, std::log10(middle), std::hypot(error, kConeGradientError),
                     [shown = std::move(shown)](const Candidate& s) { return std::log10(std::max(1e-3, shown(s))); }});
  };
  if (t.cone_gradient) add("cone: gradient [log10 kPa/m]", *t.cone_gradient, gradient);
  if (!t.cone_index || is_fine_grained(state.texture)) return;
  const double depth = (t.cone_depth.minimum + t.cone_depth.maximum) / 2;
  add("cone: index of coarse soil [log10 kPa]", *t.cone_index, [gradient, depth](const Candidate& s) {
    const double of_cohesion = bearing_capacity_factor(s.angle), shape = 1 + surcharge_factor(s.angle) / of_cohesion;
    return gradient(s) * depth + s.cohesion * of_cohesion * shape;
  });
}

void add_others(const Calibration& c, const SoilState& state, const SoilTest& t, std::vector<Clue>& clues,
                SoilPosterior& p) {
  if (t.unconfined_strength) {
    const double q = t.unconfined_strength->middle();
    clues.push_back({"unconfined compression: strength [kPa]", q, error_of(*t.unconfined_strength, kShareError * q),
                     [](const Candidate& s) { return s.cohesion / cohesion_of_unconfined(1, s.angle); }});
  }
  if (t.cone_index && is_fine_grained(state.texture)) {
    const double index = t.cone_index->middle();
    clues.push_back({"cone: index [kPa]", index,
                     std::hypot(error_of(*t.cone_index, kShareError * index), kConeError * index),
                     [](const Candidate& s) { return cone_index(1e3 * s.cohesion, s.angle) / 1e3; }});
  } else if (t.cone_index && !has_cones(c)) {
    p.left_out.push_back(
        "cone index: the formula holds for fine-grained soil, the state names no such texture, and this table holds no "
        "test of a cone (gonogo soil calibrate --onto)");
  }
  if (t.cone_gradient && !has_cones(c))
    p.left_out.push_back("cone gradient: this table holds no test of a cone (gonogo soil calibrate --onto)");
  if (has_cones(c)) add_cone(c, state, t, clues);
  if (t.bekker && plate_pressure(c, reachable_angles(c).lowest, 0) > 0)
    add_plate(c, state, *t.bekker, clues);
  else if (t.bekker)
    p.left_out.push_back("plates: this table holds no test of a plate");
}

std::vector<Clue> clues_of(const Calibration& c, const SoilState& state, SoilPosterior& p) {
  std::vector<Clue> clues;
  for (const SoilTest& t : state.tests) {
    if (t.friction_angle) add_envelope(c, t, clues);
    add_others(c, state, t, clues, p);
  }
  return clues;
}

/// Every packing and angle of the table, every cohesion.
std::vector<Candidate> grid_of(const Calibration& c, const SoilState& state) {
  std::vector<Candidate> grid;
  for (std::size_t p = 0; p < c.packing.size(); ++p) {
    const AngleRange range = reachable_angles(c, p);
    for (double angle = range.lowest; angle <= range.highest; angle += kAngleStep) {
      const sim::PairLaw law = contact_law(c, {angle, 0}, p);
      const double density = packing_density(c, angle, p);
      const double off = std::max({0.0, state.relative_density.low - density, density - state.relative_density.high});
      for (int k = 0; k <= kCohesionSteps; ++k)
        grid.push_back({angle, kMostCohesion * std::pow(double(k) / kCohesionSteps, 3), p, double(law.friction),
                        double(law.rolling_friction),
                        -0.5 * std::pow(off / 0.2, 2) + 2 * std::log(std::max(0.5, double(k)) / kCohesionSteps)});
    }
  }
  return grid;
}

/// Mean and standard deviation of a function of the candidates under their weights.
Estimated moments(const std::vector<Candidate>& grid, const std::vector<double>& weight,
                  const std::function<double(const Candidate&)>& of) {
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (weight[i] < 1e-12) continue;
    const double x = of(grid[i]);
    mean += weight[i] * x;
    square += weight[i] * x * x;
  }
  return {mean, std::sqrt(std::max(0.0, square - mean * mean))};
}

std::vector<double> weights_of(std::vector<Candidate>& grid, const std::vector<Clue>& clues) {
  double most = -1e300;
  for (Candidate& s : grid) {
    stop_if_cancelled();
    for (const Clue& clue : clues) s.log_weight -= 0.5 * std::pow((clue.given - clue.shown(s)) / clue.error, 2);
    most = std::max(most, s.log_weight);
  }
  std::vector<double> weight;
  double sum = 0;
  for (const Candidate& s : grid) sum += weight.emplace_back(std::exp(s.log_weight - most));
  for (double& w : weight) w /= sum;
  return weight;
}

/// Clues that lie beyond what any grains of the table show.
void find_beyond(const std::vector<Candidate>& grid, const std::vector<Clue>& clues, SoilPosterior& p) {
  constexpr double kMisses = 2;
  for (const Clue& clue : clues) {
    Range shown{1e300, -1e300};
    for (const Candidate& s : grid) {
      const double x = clue.shown(s);
      shown = {std::min(shown.minimum, x), std::max(shown.maximum, x)};
    }
    const double off = std::max(clue.given - shown.maximum, shown.minimum - clue.given);
    if (off > kMisses * clue.error)
      p.disagreements.push_back(line("%s is %.4g, which no grains of the table show: theirs is %.3g to %.4g",
                                     clue.what.c_str(), clue.given, shown.minimum, shown.maximum));
  }
}

bool is_angle(const Evidence& e) { return e.what.ends_with("[deg]"); }

void find_disagreements(SoilPosterior& p) {
  constexpr double kMisses = 2, kMissesAlone = 3;
  const auto text = [](const Evidence& e) {
    return line("%s is %.4g +- %.2g where the grains that fit best show %.4g", e.what.c_str(), e.given, e.error,
                e.shown);
  };
  std::vector<char> said(p.evidence.size(), 0);
  for (std::size_t i = 0; i < p.evidence.size(); ++i)  // beyond the table, and already named
    for (const std::string& sentence : p.disagreements) said[i] |= sentence.starts_with(p.evidence[i].what + " is ");
  for (std::size_t i = 0; i < p.evidence.size(); ++i)
    for (std::size_t k = i + 1; k < p.evidence.size(); ++k) {
      const Evidence &a = p.evidence[i], &b = p.evidence[k];
      if (is_angle(a) != is_angle(b)) continue;
      if (std::min(std::abs(a.deviation()), std::abs(b.deviation())) <= kMisses || a.deviation() * b.deviation() > 0)
        continue;
      said[i] = said[k] = 1;
      p.disagreements.push_back(text(a) + ", and " + text(b));
    }
  for (std::size_t i = 0; i < p.evidence.size(); ++i)
    if (!said[i] && std::abs(p.evidence[i].deviation()) > kMissesAlone) p.disagreements.push_back(text(p.evidence[i]));
}

}  // namespace

SoilPosterior soil_posterior(const Calibration& c, const SoilState& state) {
  SoilPosterior p;
  const std::vector<Clue> clues = clues_of(c, state, p);
  std::vector<Candidate> grid = grid_of(c, state);
  const std::vector<double> weight = weights_of(grid, clues);
  p.friction_angle = moments(grid, weight, [](const Candidate& s) { return s.angle; });
  p.cohesion = moments(grid, weight, [](const Candidate& s) { return s.cohesion; });
  p.friction = moments(grid, weight, [](const Candidate& s) { return s.friction; });
  p.rolling_friction = moments(grid, weight, [](const Candidate& s) { return s.rolling; });
  p.packing.assign(c.packing.size(), 0.0);
  for (std::size_t i = 0; i < grid.size(); ++i) p.packing[grid[i].packing] += weight[i];
  for (const Clue& clue : clues) {
    const Estimated shown = moments(grid, weight, clue.shown);
    p.evidence.push_back({clue.what, clue.given, clue.error, shown.mean, shown.error});
  }
  find_beyond(grid, clues, p);
  find_disagreements(p);
  if (const auto contradiction = plates_against_strength(state, &c)) p.disagreements.push_back(*contradiction);
  return p;
}

MacroscopicSoil at_stress(const MacroscopicSoil& soil, Range tested, double stress) {
  if (soil.cohesion <= 0 || (stress >= tested.minimum && stress <= tested.maximum)) return soil;
  const double slope = std::tan(to_radians(soil.friction_angle));
  const double low = soil.cohesion + slope * tested.minimum, high = soil.cohesion + slope * tested.maximum;
  const double b = std::log(high / low) / std::log(tested.maximum / tested.minimum);
  const double shear = low * std::pow(stress / tested.minimum, b);
  MacroscopicSoil s = soil;
  s.friction_angle = to_degrees(std::atan(b * shear / stress));
  s.cohesion = (1 - b) * shear;
  return s;
}

std::optional<Range> tested_stresses(const SoilState& state) {
  for (const SoilTest& t : state.tests) {
    if (!t.friction_angle) continue;
    if (!t.normal_stress || !(t.normal_stress->minimum > 0)) return std::nullopt;
    return Range{1e3 * t.normal_stress->minimum, 1e3 * t.normal_stress->maximum};
  }
  return std::nullopt;
}

double cohesion_of_cone(double index, double friction_angle) {
  const double alone = cone_index(0, friction_angle);
  if (index < alone)
    throw InputError(
        line("a cone index of %.3g kPa is less than a friction angle of %g deg shows without cohesion, %.3g "
             "kPa; give a smaller angle",
             index / 1e3, friction_angle, alone / 1e3));
  return (index - alone) / (cone_index(1, friction_angle) - alone);
}

}  // namespace gonogo::terrain
