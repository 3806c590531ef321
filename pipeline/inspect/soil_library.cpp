#include "pipeline/inspect/soil_library.h"

#include <algorithm>

#include "base/error.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "base/units.h"
#include "terrain/soil/evidence.h"

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
  if (const Json* above = off.find("plate_carries_above_Pa"))
    text += line(", a plate carries more than the %.0f MPa of its tests", above->number() / 1e6);
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

namespace {

Json json_of(const terrain::Estimated& e) { return Json::Object{{"mean", e.mean}, {"standard_error", e.error}}; }

Json json_of(const terrain::SoilPosterior& p) {
  Json j;
  j["friction_angle_deg"] = json_of(p.friction_angle);
  j["cohesion_kPa"] = json_of(p.cohesion);
  j["friction"] = json_of(p.friction);
  j["rolling_friction"] = json_of(p.rolling_friction);
  j["packing_probability"] = Json(p.packing);
  j["evidence"] = Json::array();
  for (const terrain::Evidence& e : p.evidence)
    j["evidence"].push_back(Json::Object{{"what", e.what},
                                         {"given", e.given},
                                         {"error", e.error},
                                         {"shown", e.shown},
                                         {"shown_standard_error", e.spread},
                                         {"deviation", e.deviation()}});
  j["disagreements"] = Json(p.disagreements);
  j["left_out"] = Json(p.left_out);
  return j;
}

std::string posterior_text(const terrain::SoilPosterior& p, const terrain::Calibration& c) {
  std::string text = line(
      "    together: %.1f +- %.1f deg and %.2f +- %.2f kPa of triaxial compression; sliding friction %.2f +- %.2f, "
      "rolling %.2f +- %.2f\n",
      p.friction_angle.mean, p.friction_angle.error, p.cohesion.mean, p.cohesion.error, p.friction.mean,
      p.friction.error, p.rolling_friction.mean, p.rolling_friction.error);
  text += "    packing of relative density";
  for (std::size_t k = 0; k < p.packing.size(); ++k)
    text += line("%s %.2f: %.0f %%", k ? "," : "", terrain::packing_density(c, p.friction_angle.mean, k),
                 100 * p.packing[k]);
  text += "\n";
  for (const terrain::Evidence& e : p.evidence)
    text += line("      %-44s given %8.4g +- %-6.2g shown %8.4g +- %-6.2g off by %+.1f errors\n", e.what.c_str(),
                 e.given, e.error, e.shown, e.spread, e.deviation());
  for (const std::string& sentence : p.disagreements) text += "    disagrees: " + sentence + "\n";
  for (const std::string& sentence : p.left_out) text += "    left out: " + sentence + "\n";
  return text;
}

/// The state's strength at a stress outside of its test's, with what is assumed.
std::string at_stress_text(const SoilState& s, double stress, Json& json) {
  if (stress <= 0 || s.cohesion.middle() <= 0) return "";
  const std::optional<Range> tested = terrain::tested_stresses(s);
  if (!tested)
    return line(
        "    at %.3g kPa: the test does not say its normal stresses, so that its cohesion of %.3g kPa is taken as it "
        "is; a straight line fitted above that stress has too much of it\n",
        stress / 1e3, s.cohesion.middle());
  const terrain::MacroscopicSoil there = terrain::at_stress(s.macroscopic(), *tested, stress);
  json["at_stress"] = Json::Object{{"normal_stress_kPa", stress / 1e3},
                                   {"friction_angle_deg", there.friction_angle},
                                   {"cohesion_kPa", there.cohesion / 1e3}};
  return line(
      "    at %.3g kPa: %.1f deg and %.2f kPa by %s; a power law through the ends of the tested line, %.3g to "
      "%.3g kPa, is assumed outside of them\n",
      stress / 1e3, there.friction_angle, there.cohesion / 1e3, s.meaning.text().c_str(), tested->minimum / 1e3,
      tested->maximum / 1e3);
}

}  // namespace

SoilReport weigh_evidence(const fs::path& file, const fs::path& calibration, double stress) {
  const SoilFile soil = terrain::read_soil(file);
  const terrain::Calibration table = terrain::read_calibration(calibration);
  SoilReport r;
  r.json["soil"] = soil.name;
  r.text = soil.name + " by all of its tests:\n";
  for (const SoilState& s : soil.states) {
    const terrain::SoilPosterior p = terrain::soil_posterior(table, s);
    Json state = json_of(p);
    state["state"] = s.name;
    r.text += s.name + "\n" + posterior_text(p, table) + at_stress_text(s, stress, state);
    r.json["states"].push_back(state);
  }
  return r;
}

SoilReport strength_of_cone(double index, double friction_angle) {
  SoilReport r;
  r.json["cone_index_kPa"] = index / 1e3;
  r.json["strengths"] = Json::array();
  r.text = line(
      "cone index %.3g kPa (%.3g psi) of fine-grained soil: a cone says one number of strength, and each friction "
      "angle leaves another cohesion\n",
      index / 1e3, index / kPsi);
  for (double angle = friction_angle < 0 ? 0 : friction_angle; angle <= std::max(30.0, friction_angle); angle += 5) {
    if (friction_angle < 0 && index < terrain::cone_index(0, angle)) break;
    const double cohesion = terrain::cohesion_of_cone(index, angle);
    r.json["strengths"].push_back(Json::Object{{"friction_angle_deg", angle}, {"cohesion_kPa", cohesion / 1e3}});
    r.text += line("  %4.1f deg: %6.2f kPa\n", angle, cohesion / 1e3);
    if (friction_angle >= 0) break;
  }
  r.text +=
      "by Prandtl's and Skempton's factors with 0.15 m of overburden (docs/soils.md); sand has no such relation here\n";
  return r;
}

SoilReport cone_of_soil(const fs::path& file) {
  const SoilFile soil = terrain::read_soil(file);
  SoilReport r;
  r.json["soil"] = soil.name;
  r.json["states"] = Json::array();
  for (const SoilState& s : soil.states) {
    if (!s.texture.empty() && !terrain::is_fine_grained(s.texture)) {
      r.text += s.name + ": coarse-grained, the formula does not hold\n";
      continue;
    }
    const auto index = [&s](double angle, double cohesion) {
      terrain::MacroscopicSoil end = s.macroscopic();
      end.friction_angle = angle;
      end.cohesion = 1e3 * cohesion;
      end = terrain::as_triaxial(end);
      return terrain::cone_index(end.cohesion, end.friction_angle);
    };
    const double low = index(s.friction_angle.low, s.cohesion.low),
                 high = index(s.friction_angle.high, s.cohesion.high);
    r.json["states"].push_back(Json::Object{{"state", s.name}, {"cone_index_kPa", Json::Array{low / 1e3, high / 1e3}}});
    r.text += line("%s: %.3g to %.3g kPa (%.3g to %.3g psi)%s\n", s.name.c_str(), low / 1e3, high / 1e3, low / kPsi,
                   high / kPsi, s.texture.empty() ? ", if it is fine-grained: the file names no texture" : "");
  }
  return r;
}

}  // namespace gonogo::inspect
