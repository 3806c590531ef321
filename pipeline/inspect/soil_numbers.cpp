#include "pipeline/inspect/soil_numbers.h"

#include "base/error.h"
#include "base/format.h"
#include "base/json/config.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/inspect/soil_tests.h"
#include "terrain/soil/soil.h"

namespace gonogo::inspect {
namespace {

terrain::SoilState state_of(const std::filesystem::path& file, const std::string& wanted) {
  std::vector<std::string> names;
  for (const terrain::SoilState& s : terrain::read_soil(file).states) {
    if (wanted.empty() || s.name == wanted) return s;
    names.push_back(s.name);
  }
  throw InputError(file.string() + ": no state \"" + wanted + "\"; it has: " + join_words(names));
}

/// The tests' request for the grains that the table gives the soil.
SoilTestRequest request_of(const SoilNumbersRequest& r, const terrain::Calibration& c, const terrain::SoilFit& fit) {
  SoilTestRequest t;
  t.soil.grain_diameter = c.grain_diameter;
  t.soil.shape = c.shape;
  t.soil.grain = fit.law;
  t.soil.relative_density = terrain::relative_density_of(c.packing[fit.packing].settle_friction);
  t.soil.grain_density = fit.grain_density;
  t.soil.packing_folder = campaign::default_packing_folder();
  t.seeds = r.seeds;
  t.stresses = r.stresses;
  t.plate_widths = r.plate_widths;
  t.quick = r.quick;
  t.threads = r.threads;
  t.numerics = terrain::numerics_by_table(c, r.calibration);
  return t;
}

Measure janosi_of(const std::vector<terrain::ShearResult>& results, double grain_diameter) {
  std::vector<double> k;
  for (const terrain::ShearResult& r : results) {
    std::vector<double> displacement, stress;
    for (const terrain::ShearSample& s : r.curve) {
      displacement.push_back(s.travel * grain_diameter);
      stress.push_back(s.shear_stress);
    }
    k.push_back(terrain::fit_janosi(displacement, stress, r.shear_stress));
  }
  const MeanError mean = mean_error(k);
  return {mean.mean, mean.error};
}

}  // namespace

SoilNumbers measure_soil_numbers(const SoilNumbersRequest& r) {
  const terrain::SoilState state = state_of(r.soil, r.state);
  terrain::Calibration c = terrain::read_calibration(r.calibration);
  if (r.grain > 0) c.grain_diameter = r.grain;
  const terrain::SoilFit fit = terrain::fit_soil(c, state.macroscopic());
  const SoilTestRequest tests = request_of(r, c, fit);
  const auto plates = run_plates(tests, nullptr);
  const auto sheared = run_shear(tests, nullptr);
  const terrain::BekkerFit bekker = fit_bekker(plates);
  const terrain::ShearStrength strength = shear_strength(sheared);
  SoilNumbers n{.soil = r.soil.stem().string(), .state = state.name, .table = r.calibration.filename().string()};
  n.grain_diameter = c.grain_diameter;
  n.n = {bekker.n, bekker.n_error};
  n.k_c = {bekker.k_c, bekker.k_c_error};
  n.k_phi = {bekker.k_phi, bekker.k_phi_error};
  n.cohesion = {strength.steady_cohesion, strength.steady_cohesion_error};
  n.friction_angle = {strength.steady_angle.degrees, strength.steady_angle.error};
  n.peak_cohesion = {strength.peak_cohesion, strength.peak_cohesion_error};
  n.peak_friction_angle = {strength.peak_angle.degrees, strength.peak_angle.error};
  n.janosi = janosi_of(sheared, c.grain_diameter);
  n.bulk_density = fit.bulk_density;
  n.plate_r2 = bekker.r2;
  n.shear_r2 = strength.steady_r2;
  for (const double w : r.plate_widths) n.plate_widths.push_back(w * c.grain_diameter);
  n.stresses = r.stresses;
  return n;
}

namespace {

constexpr const char* kSchema = "gonogo/bekker/1";

/// A number of a "bekker" file: its key, with the unit.
struct Entry {
  const char* key;
  Measure SoilNumbers::*number;
};
constexpr Entry kEntries[] = {{"n", &SoilNumbers::n},
                              {"k_c_N_per_m_n_plus_1", &SoilNumbers::k_c},
                              {"k_phi_N_per_m_n_plus_2", &SoilNumbers::k_phi},
                              {"cohesion_Pa", &SoilNumbers::cohesion},
                              {"friction_angle_deg", &SoilNumbers::friction_angle},
                              {"peak_cohesion_Pa", &SoilNumbers::peak_cohesion},
                              {"peak_friction_angle_deg", &SoilNumbers::peak_friction_angle},
                              {"janosi_K_m", &SoilNumbers::janosi}};

Json bekker_json(const SoilNumbers& s) {
  Json j;
  j["schema"] = kSchema;
  j["soil"] = s.soil;
  j["state"] = s.state;
  j["calibration"] = s.table;
  j["grain_diameter_m"] = s.grain_diameter;
  j["bulk_density_kg_per_m3"] = s.bulk_density;
  for (const Entry& e : kEntries) {
    j[e.key] = Json::Object{{"value", (s.*e.number).value}, {"standard_error", (s.*e.number).error}};
  }
  j["plate_r2"] = s.plate_r2;
  j["shear_r2"] = s.shear_r2;
  j["plate_widths_m"] = s.plate_widths;
  j["normal_stresses_Pa"] = s.stresses;
  return j;
}

/// Keys as the arguments of SetSoilParameters are called.
Json scm_json(const SoilNumbers& s) {
  Json j, errors;
  const auto set = [&](const char* key, const Measure& m) {
    j[key] = m.value;
    errors[key] = m.error;
  };
  set("Bekker_Kphi", s.k_phi);
  set("Bekker_Kc", s.k_c);
  set("Bekker_n", s.n);
  set("Mohr_cohesion", s.cohesion);
  set("Mohr_friction", s.friction_angle);
  set("Janosi_shear", s.janosi);
  j["standard_errors"] = std::move(errors);
  j["units"] = "SI; Mohr_friction in degrees";
  j["not_measured"] = "elastic_K, damping_R";
  j["source"] = s.soil + ", " + s.state + ", grains of " + line("%g m", s.grain_diameter) + " by " + s.table;
  return j;
}

}  // namespace

Json numbers_json(const SoilNumbers& s, const std::string& format) {
  if (format == "bekker") return bekker_json(s);
  if (format == "scm") return scm_json(s);
  throw InputError("format \"" + format + "\": there are bekker and scm");
}

std::string numbers_text(const SoilNumbers& s) {
  std::string text =
      line("%s, %s: grains of %g m by %s\n", s.soil.c_str(), s.state.c_str(), s.grain_diameter, s.table.c_str());
  text += line("n          %8.3f +- %.3f\n", s.n.value, s.n.error);
  text += line("k_c        %8.1f +- %.1f kN/m^(n+1)\n", s.k_c.value / 1e3, s.k_c.error / 1e3);
  text += line("k_phi      %8.0f +- %.0f kN/m^(n+2)\n", s.k_phi.value / 1e3, s.k_phi.error / 1e3);
  text += line("c          %8.0f +- %.0f Pa, at the peak %.0f +- %.0f\n", s.cohesion.value, s.cohesion.error,
               s.peak_cohesion.value, s.peak_cohesion.error);
  text += line("phi        %8.1f +- %.1f deg, at the peak %.1f +- %.1f\n", s.friction_angle.value,
               s.friction_angle.error, s.peak_friction_angle.value, s.peak_friction_angle.error);
  text += line("K          %8.1f +- %.1f mm\n", 1e3 * s.janosi.value, 1e3 * s.janosi.error);
  return text;
}

SoilNumbers read_soil_numbers(const std::filesystem::path& file) {
  const Config c = Config::read(file);
  c.choice("schema", {kSchema});
  SoilNumbers s{.soil = c.text("soil"), .state = c.text("state"), .table = c.text("calibration")};
  s.grain_diameter = c.number("grain_diameter_m", {1e-4, 1});
  s.bulk_density = c.number("bulk_density_kg_per_m3", {100, 1e4});
  for (const Entry& e : kEntries) {
    const Config one = c.object(e.key);
    s.*e.number = {one.number("value"), one.number("standard_error", {0, 1e12})};
    one.finish();
  }
  s.plate_r2 = c.number("plate_r2");
  s.shear_r2 = c.number("shear_r2");
  s.plate_widths = c.numbers("plate_widths_m");
  s.stresses = c.numbers("normal_stresses_Pa");
  c.finish();
  return s;
}

}  // namespace gonogo::inspect
