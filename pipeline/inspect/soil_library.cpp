#include "pipeline/inspect/soil_library.h"

#include "base/error.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "terrain/soil/soil.h"

namespace gonogo::inspect {
namespace {

namespace fs = std::filesystem;
using terrain::SoilFile;
using terrain::SoilState;
using terrain::SoilValue;

/// Calibration tables lie in the soils' folder too.
constexpr const char* kNoSoils = "calibration_";

std::string text_of(const SoilValue& v) { return v.fixed() ? line("%g", v.low) : line("%g to %g", v.low, v.high); }

Json json_of(const SoilValue& v) {
  Json j;
  if (v.fixed())
    j["fixed"] = v.low;
  else
    j["range"] = Json::Array{v.low, v.high};
  if (!v.source.empty()) j["source"] = v.source;
  if (!v.no_source.empty()) j["no_source"] = v.no_source;
  return j;
}

Json state_json(const SoilState& s) {
  Json j;
  j["state"] = s.name;
  if (s.water_percent) j["water_percent"] = *s.water_percent;
  j["test"] = name_of(s.meaning.test);
  j["stage"] = s.meaning.stage == terrain::Stage::peak ? "peak" : "residual";
  if (s.meaning.assumed) j["test_is_assumed"] = true;
  j["friction_angle_deg"] = json_of(s.friction_angle);
  j["cohesion_kPa"] = json_of(s.cohesion);
  j["bulk_density_kg_per_m3"] = json_of(s.bulk_density);
  j["relative_density"] = json_of(s.relative_density);
  if (!s.bekker) return j;
  j["bekker_n"] = json_of(s.bekker->n);
  j["bekker_k_c_kN_per_m_n_plus_1"] = json_of(s.bekker->k_c);
  j["bekker_k_phi_kN_per_m_n_plus_2"] = json_of(s.bekker->k_phi);
  return j;
}

std::string sources_text(const SoilState& s) {
  std::string text;
  const auto add = [&](const char* what, const SoilValue& v) {
    text += line("    %s: ", what) + (v.source.empty() ? "no source: " + v.no_source : v.source) + "\n";
  };
  add("friction angle", s.friction_angle);
  if (s.cohesion.source != s.friction_angle.source) add("cohesion", s.cohesion);
  add("bulk density", s.bulk_density);
  add("relative density", s.relative_density);
  return text;
}

std::string state_text(const SoilState& s) {
  std::string text = s.name + "\n";
  text += line("    friction angle %s deg (%s), cohesion %s kPa, bulk density %s kg/m3, relative density %s\n",
               text_of(s.friction_angle).c_str(), s.meaning.text().c_str(), text_of(s.cohesion).c_str(),
               text_of(s.bulk_density).c_str(), text_of(s.relative_density).c_str());
  if (s.meaning.assumed)
    text += "    the angle does not say its test: " + terrain::readings_of(s.friction_angle.middle()) + "\n";
  if (s.bekker)
    text += line("    Bekker n %s, k_c %s kN/m^(n+1), k_phi %s kN/m^(n+2)\n", text_of(s.bekker->n).c_str(),
                 text_of(s.bekker->k_c).c_str(), text_of(s.bekker->k_phi).c_str());
  return text + sources_text(s) + (s.note.empty() ? "" : "    note: " + s.note + "\n");
}

std::string fit_text(const Json& fit) {
  if (const Json* refused = fit.find("refused")) return "    grains: " + refused->string() + "\n";
  const Json& off = fit.at("mismatch");
  std::string text;
  if (const Json* angle = fit.find("triaxial_friction_angle_deg"))
    text += line("    in triaxial compression these grains show %.1f deg and %.2f kPa\n", angle->number(),
                 fit.at("triaxial_cohesion_kPa").number());
  text += line("    grains: sliding friction %.3f, rolling %.3f, cohesion pressure %.1f kPa, solid %.0f kg/m3\n",
               fit.at("friction").number(), fit.at("rolling_friction").number(),
               fit.at("cohesion_pressure_Pa").number() / 1e3, fit.at("grain_density_kg_per_m3").number());
  text += line("    mismatch: friction angle %+.2f +- %.2f deg, cohesion %+.0f +- %.0f %%, bulk density %+.1f %%",
               off.at("friction_angle_deg").number(), off.at("friction_angle_error_deg").number(),
               100 * off.at("cohesion").number(), 100 * off.at("cohesion_error").number(),
               100 * off.at("bulk_density").number());
  text += line(", relative density %+.2f", off.at("relative_density").number());
  if (const Json* sinkage = off.find("sinkage"))
    text += line(", pressure under a plate %+.0f %%", 100 * sinkage->number());
  return text + "\n";
}

}  // namespace

fs::path soil_file(const std::string& name) { return shipped_file("soils", "soil", name, kNoSoils); }

SoilReport list_soils() {
  const auto places = shipped_folders("soils");
  if (places.empty()) throw InputError("no folder configs/soils here or beside the program's sources");
  SoilReport r;
  r.json["soils"] = Json::array();
  for (const std::string& name : shipped_names(places[0], kNoSoils)) {
    const SoilFile soil = terrain::read_soil(places[0] / (name + ".json"));
    Json entry = Json::Object{{"file", name}, {"name", soil.name}};
    for (const SoilState& s : soil.states) entry["states"].push_back(s.name);
    r.json["soils"].push_back(entry);
    r.text += line("%-12s %s, %zu %s\n", name.c_str(), soil.name.c_str(), soil.states.size(),
                   soil.states.size() == 1 ? "state" : "states");
  }
  return r;
}

SoilReport show_soil(const fs::path& file, const fs::path& calibration) {
  const SoilFile soil = terrain::read_soil(file);
  SoilReport r;
  r.json["soil"] = soil.name;
  r.text = soil.name + ": " + soil.about + "\n\n";
  const auto table =
      calibration.empty() ? std::optional<terrain::Calibration>{} : terrain::read_calibration(calibration);
  for (const SoilState& s : soil.states) {
    Json state = state_json(s);
    r.text += state_text(s);
    if (table) {
      state["grains"] = fit_record(*table, s);
      r.text += fit_text(state.at("grains"));
    }
    r.json["states"].push_back(state);
  }
  return r;
}

}  // namespace gonogo::inspect
