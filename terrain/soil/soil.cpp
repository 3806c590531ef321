#include "terrain/soil/soil.h"

#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/json/config.h"

namespace gonogo::terrain {

namespace {

SoilValue read_value(const Config& values, const std::string& key, Range allowed) {
  const Config c = values.object(key);
  SoilValue v;
  if (c.has("fixed") == c.has("range")) c.fail("", "needs either \"fixed\" or \"range\"");
  if (c.has("fixed")) {
    v.low = v.high = c.number("fixed", allowed);
  } else {
    const auto range = c.numbers("range", allowed);
    if (range.size() != 2 || !(range[0] <= range[1])) c.fail("range", "needs two numbers, the lower one first");
    v.low = range[0];
    v.high = range[1];
  }
  v.source = c.text_or("source", "");
  v.no_source = c.text_or("no_source", "");
  v.note = c.text_or("note", "");
  if (v.source.empty() == v.no_source.empty())
    c.fail("", "needs a \"source\", or \"no_source\" that says why the range is what it is");
  if (v.fixed() && c.has("range")) c.fail("range", "is one value; write it as \"fixed\"");
  c.finish();
  return v;
}

SoilState read_state(const Config& c) {
  SoilState s;
  s.name = c.text("name");
  s.texture = c.text_or("texture", "");
  s.note = c.text_or("note", "");
  if (c.has("moisture")) s.moisture = c.choice("moisture", {"dry", "moist", "wet"});
  if (c.has("water_percent")) s.water_percent = c.number("water_percent", {0, 1000});
  const Config v = c.object("values");
  s.friction_angle = read_value(v, "friction_angle_deg", {0, 60});
  s.cohesion = read_value(v, "cohesion_kPa", {0, 200});
  s.bulk_density = read_value(v, "bulk_density_kg_per_m3", {800, 2500});
  s.relative_density = read_value(v, "relative_density", {0, 1});
  if (v.has("bekker_n") || v.has("bekker_k_c_kN_per_m_n_plus_1") || v.has("bekker_k_phi_kN_per_m_n_plus_2"))
    s.bekker = Bekker{read_value(v, "bekker_n", {0.01, 3}), read_value(v, "bekker_k_c_kN_per_m_n_plus_1", {-1e5, 1e5}),
                      read_value(v, "bekker_k_phi_kN_per_m_n_plus_2", {0, 1e6})};
  if (v.has("janosi_K_mm")) s.janosi = read_value(v, "janosi_K_mm", {0.01, 1000});
  v.finish();
  c.finish();
  return s;
}

Json fits_of(const Calibration& calibration, const std::vector<SoilState>& states) {
  Json rows = Json::array();
  for (const SoilState& s : states) rows.push_back(fit_record(calibration, s));
  return rows;
}

/// Bekker's modulus of the soil for the table's plate, over that of the grains, as pressures at one grain's depth;
/// less one.
double sinkage_mismatch(const Calibration& c, const SoilFit& fit, const Bekker& b) {
  const double z = c.grain_diameter, width = 4 * c.grain_diameter;
  const double soil = 1e3 * (b.k_c.middle() / width + b.k_phi.middle()) * std::pow(z, b.n.middle());
  return fit.sinkage_modulus * std::pow(z, fit.sinkage_exponent) / soil - 1;
}

}  // namespace

MacroscopicSoil SoilState::macroscopic() const {
  return {friction_angle.middle(), 1e3 * cohesion.middle(), bulk_density.middle(), relative_density.middle()};
}

SoilFile read_soil(const std::filesystem::path& path) {
  const Config file = Config::read(path);
  file.choice("schema", {"gonogo/soil/1"});
  SoilFile soil;
  soil.name = file.text("name");
  soil.about = file.text("about");
  for (const Config& state : file.objects("states")) soil.states.push_back(read_state(state));
  if (soil.states.empty()) file.fail("states", "needs at least one");
  if (file.has("fits")) {
    file.object("fits");
    soil.fits = file.json().at("fits");
  }
  file.finish();
  return soil;
}

Json fit_record(const Calibration& calibration, const SoilState& state) {
  Json j;
  j["state"] = state.name;
  const MacroscopicSoil soil = state.macroscopic();
  try {
    const SoilFit f = fit_soil(calibration, soil);
    j["friction"] = double(f.law.friction);
    j["rolling_friction"] = double(f.law.rolling_friction);
    j["cohesion_pressure_Pa"] = double(f.law.cohesion_pressure);
    j["relative_density"] = f.relative_density;
    j["grain_density_kg_per_m3"] = f.grain_density;
    Json off;
    off["friction_angle_deg"] = f.friction_angle - soil.friction_angle;
    off["friction_angle_error_deg"] = f.friction_angle_error;
    off["cohesion"] = soil.cohesion > 0 ? f.cohesion / soil.cohesion - 1 : 0;
    off["cohesion_error"] = soil.cohesion > 0 ? f.cohesion_error / soil.cohesion : 0;
    off["bulk_density"] = f.bulk_density / soil.bulk_density - 1;
    off["relative_density"] = f.relative_density - soil.relative_density;
    if (state.bekker && f.sinkage_modulus > 0) off["sinkage"] = sinkage_mismatch(calibration, f, *state.bekker);
    j["mismatch"] = off;
  } catch (const InputError& e) {
    j["refused"] = std::string(e.what());
  }
  return j;
}

void write_fits(const std::filesystem::path& path, const std::string& table, const Calibration& calibration) {
  const SoilFile soil = read_soil(path);
  Json file = Json::read(path);
  Json fits = soil.fits.is_object() ? soil.fits : Json::object();
  fits[table] = fits_of(calibration, soil.states);
  file["fits"] = fits;
  write_file_atomically(path, file.dump(2) + "\n");
}

}  // namespace gonogo::terrain
