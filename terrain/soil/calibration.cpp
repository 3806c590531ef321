#include "terrain/soil/calibration.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/json/config.h"

namespace gonogo::terrain {

Numerics numerics_by_table(const Calibration& table, const std::filesystem::path& file, const AskedNumerics& asked) {
  if (!asked.complete() && !states_numerics(table.provenance))
    throw InputError(file.string() +
                     ": provenance does not say step_s, substeps, iterations and tolerance_m_per_s of the tests, and a "
                     "friction angle belongs to them; give --step, --substeps, --iterations, --tolerance and --target, "
                     "in a study all of trial.numerics, or calibrate again");
  Numerics n = asked.complete() ? Numerics{} : read_numerics(table.provenance);
  // The table's angles belong to its give too. Older tables state none and are rigid.
  if (states_numerics(table.provenance)) n.give = read_numerics(table.provenance).give;
  n.step = asked.step.value_or(n.step);
  n.substeps = asked.substeps.value_or(n.substeps);
  n.iterations = asked.iterations.value_or(n.iterations);
  n.tolerance = asked.tolerance.value_or(n.tolerance);
  n.target = asked.target.value_or(n.target);
  n.contact = asked.contact.value_or(n.contact);
  n.overlap = asked.overlap.value_or(n.overlap);
  n.give = asked.give.value_or(n.give);
  if (!sim::is_penalty(n.contact)) return n;
  if (!asked.substeps) n.substeps = 1;
  if (!asked.give) n.give = 0;
  return n;
}

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

/// Relative density of a packing, for the grains of a place on the line.
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

/// Which of a table's curves shows an angle of this meaning. Soil on a slope at rest has sheared: heaps of grains
/// repose at their steady triaxial angle (docs/validation.md).
Angle measured(const SoilResponse& r, const AngleMeaning& m) {
  const bool peak = m.stage == Stage::peak;
  if (m.is_on_plane()) return peak ? r.shear_peak : r.shear_steady;
  if (m.test == StrengthTest::repose) return {r.steady_friction_angle, 0};
  if (m.test != StrengthTest::triaxial) return {};
  return peak ? Angle{r.friction_angle, r.friction_angle_error} : Angle{r.steady_friction_angle, 0};
}

/// Angles of all contact levels in a packing; empty where the table has no such curve. Means of neighbours in place of
/// falls, so that the curve can be inverted (pool adjacent violators).
std::vector<double> curve_of(const Calibration& c, std::size_t packing, const AngleMeaning& meaning) {
  if (!knows_packings(c)) return {};
  struct Block {
    double sum;
    std::size_t count;
    double mean() const { return sum / double(count); }
  };
  std::vector<Block> block;
  for (std::size_t k = 0; k < c.contact.size(); ++k) {
    const double angle = measured(c.response[k * c.packing.size() + packing], meaning).degrees;
    if (!(angle > 0)) return {};
    block.push_back({angle, 1});
    for (std::size_t n = block.size(); n > 1 && block[n - 2].mean() > block[n - 1].mean(); n = block.size()) {
      block[n - 2] = {block[n - 2].sum + block[n - 1].sum, block[n - 2].count + block[n - 1].count};
      block.pop_back();
    }
  }
  std::vector<double> curve;
  for (const Block& b : block) curve.insert(curve.end(), b.count, b.mean());
  return curve;
}

/// Value of the curve (x, y) at `at`; in proportion below, and as much higher above.
double along(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (at <= x.front()) return y.front() * at / x.front();
  if (at >= x.back()) return y.back() + at - x.back();
  const std::size_t k = std::size_t(std::upper_bound(x.begin(), x.end(), at) - x.begin());
  return y[k - 1] + (y[k] - y[k - 1]) * (at - x[k - 1]) / std::max(1e-9, x[k] - x[k - 1]);
}

/// In a packing: of the angle's meaning to triaxial compression, or back.
double converted(const Calibration& c, std::size_t packing, const AngleMeaning& from, const AngleMeaning& to,
                 double angle) {
  return along(curve_of(c, packing, from), curve_of(c, packing, to), angle);
}

/// The packing whose relative density is nearest, by the triaxial angle that the soil has in each.
template <class AngleIn>
std::size_t nearest_packing(const Calibration& c, double density, AngleIn angle_in) {
  const auto off = [&](std::size_t p) {
    return std::fabs(relative_density(c, nearest_place(c, angle_in(p), p), p) - density);
  };
  std::size_t best = 0;
  for (std::size_t p = 1; p < c.packing.size(); ++p)
    if (off(p) < off(best)) best = p;
  return best;
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

MacroscopicSoil as_triaxial(const MacroscopicSoil& soil) {
  MacroscopicSoil s = soil;
  s.meaning = {};
  const AngleMeaning& m = soil.meaning;
  if (m.test == StrengthTest::plane_strain) {
    s.friction_angle /= kPlaneStrainRatio;
  } else if (m.is_on_plane()) {
    s.friction_angle = angle_of_triaxial(soil.friction_angle, m.dilation);
    s.cohesion /= cohesion_on_plane(s.friction_angle, m.dilation);
  } else if (m.test != StrengthTest::triaxial && m.test != StrengthTest::repose) {
    throw InputError("soil: the test " + name_of(m.test) +
                     " shows no friction angle; give one of triaxial compression, direct shear, ring shear, plane "
                     "strain or repose");
  }
  return s;
}

MacroscopicSoil as_triaxial(const Calibration& c, const MacroscopicSoil& soil) {
  const AngleMeaning& m = soil.meaning;
  if (m.is_triaxial_peak()) return soil;
  // A dilation that was measured says more than grains that dilate as they do.
  if (m.dilation != 0 || curve_of(c, 0, m).empty()) return as_triaxial(soil);
  const auto angle_in = [&](std::size_t p) { return converted(c, p, m, {}, soil.friction_angle); };
  MacroscopicSoil s = soil;
  s.meaning = {};
  s.friction_angle = angle_in(nearest_packing(c, soil.relative_density, angle_in));
  if (m.is_on_plane()) s.cohesion /= cohesion_on_plane(s.friction_angle);
  return s;
}

double shown_angle(const Calibration& c, std::size_t packing, double triaxial, const AngleMeaning& m) {
  if (m.is_triaxial_peak()) return triaxial;
  if (m.dilation == 0 && !curve_of(c, packing, m).empty()) return converted(c, packing, {}, m, triaxial);
  if (m.test == StrengthTest::plane_strain) return triaxial * kPlaneStrainRatio;
  return m.is_on_plane() ? angle_on_plane(triaxial, m.dilation) : triaxial;
}

double packing_density(const Calibration& c, double triaxial, std::size_t packing) {
  return relative_density(c, nearest_place(c, triaxial, packing), packing);
}

namespace {

constexpr AngleMeaning kOnPlane{StrengthTest::direct_shear, Stage::peak};

bool is_on_plane_at_peak(const AngleMeaning& m) { return m.is_on_plane() && m.stage == Stage::peak; }

}  // namespace

MacroscopicSoil on_shear_plane(const MacroscopicSoil& soil) {
  if (is_on_plane_at_peak(soil.meaning)) return soil;
  MacroscopicSoil s = as_triaxial(soil);
  s.cohesion *= cohesion_on_plane(s.friction_angle);
  s.friction_angle = angle_on_plane(s.friction_angle);
  s.meaning = kOnPlane;
  return s;
}

MacroscopicSoil on_shear_plane(const Calibration& c, const MacroscopicSoil& soil) {
  if (is_on_plane_at_peak(soil.meaning)) return soil;
  MacroscopicSoil s = as_triaxial(c, soil);
  if (curve_of(c, 0, kOnPlane).empty()) return on_shear_plane(s);
  s.cohesion *= cohesion_on_plane(s.friction_angle);
  s.friction_angle = converted(c, packing_level(c, s), {}, kOnPlane, s.friction_angle);
  s.meaning = kOnPlane;
  return s;
}

std::size_t packing_level(const Calibration& c, const MacroscopicSoil& soil) {
  const double angle = as_triaxial(c, soil).friction_angle;
  return nearest_packing(c, soil.relative_density, [&](std::size_t) { return angle; });
}

double reachable_cohesion(const Calibration& c, double friction_angle, std::size_t packing) {
  return max_cohesion(c, place_on_line(c, friction_angle, packing));
}

sim::PairLaw contact_law(const Calibration& c, const MacroscopicSoil& given, std::size_t packing) {
  const MacroscopicSoil soil = as_triaxial(c, given);
  const PlaceOnLine at = place_on_line(c, soil.friction_angle, packing);
  check_cohesion_reach(c, soil, at);
  const ContactLevel &a = c.contact[at.level - 1], &b = c.contact[at.level];
  return {Real(at.between(a.friction, b.friction)), Real(at.between(a.rolling_friction, b.rolling_friction)),
          Real(soil.cohesion / gain_at(c, at))};
}

namespace {

std::pair<const SoilResponse&, const SoilResponse&> responses(const Calibration& c, const PlaceOnLine& at,
                                                              std::size_t packing) {
  return {c.response[(at.level - 1) * c.packing.size() + packing], c.response[at.level * c.packing.size() + packing]};
}

/// By its logarithm, since levels have different exponents; 0 where the table does not know.
double plate_pressure(const Calibration& c, const PlaceOnLine& at, std::size_t packing) {
  const auto [low, high] = responses(c, at, packing);
  if (!(low.sinkage_modulus > 0 && high.sinkage_modulus > 0)) return 0;
  const auto log_pressure = [&](const SoilResponse& r) {
    return std::log(r.sinkage_modulus) + r.sinkage_exponent * std::log(c.grain_diameter);
  };
  return std::exp(at.between(log_pressure(low), log_pressure(high)));
}

}  // namespace

double plate_pressure(const Calibration& c, double triaxial, std::size_t packing) {
  return c.response.empty() ? 0 : plate_pressure(c, nearest_place(c, triaxial, packing), packing);
}

double cone_gradient(const Calibration& c, double triaxial, std::size_t packing) {
  if (c.response.empty()) return 0;
  const PlaceOnLine at = nearest_place(c, triaxial, packing);
  const auto [low, high] = responses(c, at, packing);
  if (!(low.cone_gradient > 0 && high.cone_gradient > 0)) return 0;
  return std::exp(at.between(std::log(low.cone_gradient), std::log(high.cone_gradient)));
}

SoilFit fit_soil(const Calibration& c, const MacroscopicSoil& given) {
  const MacroscopicSoil soil = as_triaxial(c, given);
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
    const auto [low, high] = responses(c, at, f.packing);
    f.sinkage_exponent = at.between(low.sinkage_exponent, high.sinkage_exponent);
    // Rigid grains: pressure goes with the density of the solid, that of the table being quartz.
    f.sinkage_modulus =
        plate_pressure(c, at, f.packing) / std::pow(c.grain_diameter, f.sinkage_exponent) * f.grain_density / kQuartz;
  }
  return f;
}

namespace {

/// 1: without "response"; 2: without "shape", of spheres; 3: friction angles by simple shear; 4: one loosest packing
/// for all contact levels; 5: without angles on the plane of shear; 6: without cones.
const std::vector<std::string> kSchemas = {"gonogo/calibration/1", "gonogo/calibration/2", "gonogo/calibration/3",
                                           "gonogo/calibration/4", "gonogo/calibration/5", "gonogo/calibration/6",
                                           "gonogo/calibration/7"};

Angle read_angle(const Config& row, const std::string& name) {
  return {row.number(name + "_deg", {0, 89}), row.number(name + "_error_deg", {0, 89})};
}

void write_angle(Json& row, const std::string& name, const Angle& angle) {
  row[name + "_deg"] = angle.degrees;
  row[name + "_error_deg"] = angle.error;
}

/// One row for each contact level and packing, in that order.
std::vector<SoilResponse> read_responses(const Config& file, const Calibration& c, std::ptrdiff_t version) {
  if (c.packing.empty()) file.fail("packing", "needs at least two packings");
  std::vector<SoilResponse> rows;
  for (const Config& row : file.objects("response")) {
    SoilResponse r;
    r.contact = rows.size() / c.packing.size();
    r.packing = rows.size() % c.packing.size();
    if (row.integer("contact") != std::int64_t(r.contact) || row.integer("packing") != std::int64_t(r.packing))
      row.fail("", "rows must go through the packings of each contact level in turn");
    if (version <= 3) {
      row.number("friction_angle_deg", {0, 89});
      row.number("peak_friction_angle_deg", {0, 89});
    } else {
      r.friction_angle = row.number("friction_angle_deg", {1e-3, 89});
      r.friction_angle_error = row.number("friction_angle_error_deg", {0, 89});
      r.steady_friction_angle = row.number("steady_friction_angle_deg", {0, 89});
    }
    if (version >= 6) {
      r.shear_peak = read_angle(row, "shear_peak_angle");
      r.shear_steady = read_angle(row, "shear_steady_angle");
    }
    r.cohesion_gain = row.number("cohesion_gain", {-100, 100});
    r.sinkage_modulus = row.number("sinkage_modulus_N_per_m_n_plus_2", {0, 1e15});
    r.sinkage_modulus_error = row.number("sinkage_modulus_error", {0, 1e15});
    r.sinkage_exponent = row.number("sinkage_exponent", {-10, 10});
    if (version >= 7) {
      r.cone_gradient = row.number("cone_gradient_over_unit_weight", {0, 1e6});
      r.cone_gradient_error = row.number("cone_gradient_error", {0, 1e6});
    }
    row.finish();
    rows.push_back(r);
  }
  if (rows.empty() || rows.size() != c.packing.size() * c.contact.size())
    file.fail("response", "needs one row for each contact level and packing");
  return rows;
}

}  // namespace

void write_calibration(const std::filesystem::path& path, const Calibration& c) {
  Json j;
  const bool has_shear = !c.response.empty() && c.response.front().shear_peak.degrees > 0;
  const bool has_cones =
      has_shear && std::any_of(c.response.begin(), c.response.end(), [](const auto& r) { return r.cone_gradient > 0; });
  j["schema"] = kSchemas[has_cones ? 6 : has_shear ? 5 : c.contact.front().loosest_solid_fraction > 0 ? 4 : 3];
  j["grain_diameter_m"] = c.grain_diameter;
  j["shape"] = name_of(c.shape);
  for (const PackingLevel& p : c.packing) {
    Json row;
    row["settle_friction"] = p.settle_friction;
    row["solid_fraction"] = p.solid_fraction;
    row["relative_density"] = p.relative_density;
    j["packing"].push_back(row);
  }
  for (const ContactLevel& l : c.contact) {
    Json row;
    row["friction"] = l.friction;
    row["rolling_friction"] = l.rolling_friction;
    row["friction_angle_deg"] = l.friction_angle;
    row["friction_angle_error_deg"] = l.friction_angle_error;
    row["cohesion_gain"] = l.cohesion_gain;
    row["cohesion_gain_error"] = l.cohesion_gain_error;
    if (l.loosest_solid_fraction > 0) row["loosest_solid_fraction"] = l.loosest_solid_fraction;
    j["contact"].push_back(row);
  }
  for (const SoilResponse& r : c.response) {
    Json row;
    row["contact"] = std::uint64_t(r.contact);
    row["packing"] = std::uint64_t(r.packing);
    row["friction_angle_deg"] = r.friction_angle;
    row["friction_angle_error_deg"] = r.friction_angle_error;
    row["steady_friction_angle_deg"] = r.steady_friction_angle;
    if (has_shear) {
      write_angle(row, "shear_peak_angle", r.shear_peak);
      write_angle(row, "shear_steady_angle", r.shear_steady);
    }
    row["cohesion_gain"] = r.cohesion_gain;
    row["sinkage_modulus_N_per_m_n_plus_2"] = r.sinkage_modulus;
    row["sinkage_modulus_error"] = r.sinkage_modulus_error;
    row["sinkage_exponent"] = r.sinkage_exponent;
    if (has_cones) {
      row["cone_gradient_over_unit_weight"] = r.cone_gradient;
      row["cone_gradient_error"] = r.cone_gradient_error;
    }
    j["response"].push_back(row);
  }
  j["cohesion_gain"] = c.cohesion_gain;
  j["cohesion_gain_error"] = c.cohesion_gain_error;
  j["provenance"] = c.provenance;
  write_file_atomically(path, j.dump(2) + "\n");
}

Calibration read_calibration(const std::filesystem::path& path) { return read_calibration(Config::read(path)); }

Calibration read_calibration(const Config& file) {
  const std::string schema = file.choice("schema", kSchemas);
  const auto version = 1 + std::find(kSchemas.begin(), kSchemas.end(), schema) - kSchemas.begin();
  Calibration c;
  c.grain_diameter = file.number("grain_diameter_m", {1e-5, 1});
  if (version >= 3 && file.has("shape")) c.shape = grain_shape_of(file.choice("shape", grain_shape_names()));
  if (file.has("provenance")) c.provenance = file.json().at("provenance");
  for (const Config& row : file.objects("packing"))
    c.packing.push_back({.settle_friction = row.number("settle_friction", {0, 10}),
                         .solid_fraction = row.number("solid_fraction", {0.3, 0.75}),
                         .relative_density = row.number("relative_density", {0, 1})});
  for (const Config& row : file.objects("contact"))
    c.contact.push_back(
        {.friction = row.number("friction", {0, 10}),
         .rolling_friction = row.number("rolling_friction", {0, 10}),
         .friction_angle = row.number("friction_angle_deg", {0, 89}),
         .friction_angle_error = row.number("friction_angle_error_deg", {0, 89}),
         .cohesion_gain = row.number("cohesion_gain", {-100, 100}),
         .cohesion_gain_error = row.number("cohesion_gain_error", {0, 100}),
         .loosest_solid_fraction = version >= 5 ? row.number("loosest_solid_fraction", {0.3, 0.75}) : 0});
  if (version == 2 || (version >= 3 && file.has("response"))) c.response = read_responses(file, c, version);
  c.cohesion_gain = file.number("cohesion_gain", {1e-6, 100});
  c.cohesion_gain_error = file.number("cohesion_gain_error", {0, 100});
  file.finish();
  if (c.packing.size() < 2 || c.contact.size() < 2) file.fail("", "needs at least two packings and two contact levels");
  return c;
}

}  // namespace gonogo::terrain
