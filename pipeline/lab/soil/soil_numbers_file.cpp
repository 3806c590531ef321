#include "base/error.h"
#include "base/json/config.h"
#include "base/line.h"
#include "pipeline/lab/soil/soil_numbers.h"

namespace gonogo::lab {
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

Json of_list(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double x : values) list.push_back(x);
  return list;
}

Json bekker_json(const SoilNumbers& s) {
  Json j;
  j["schema"] = kSchema;
  j["soil"] = s.soil;
  j["state"] = s.state;
  j["calibration"] = s.table;
  j["grain_diameter_m"] = s.grain_diameter;
  j["bulk_density_kg_per_m3"] = s.bulk_density;
  for (const Entry& e : kEntries) {
    Json one;
    one["value"] = (s.*e.number).value;
    one["standard_error"] = (s.*e.number).error;
    j[e.key] = std::move(one);
  }
  j["plate_r2"] = s.plate_r2;
  j["shear_r2"] = s.shear_r2;
  j["plate_widths_m"] = of_list(s.plate_widths);
  j["normal_stresses_Pa"] = of_list(s.stresses);
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

}  // namespace gonogo::lab
