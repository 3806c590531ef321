// Calibration tables as files: JSON, schema gonogo/calibration/5 and all before it.
#include <algorithm>

#include "base/file.h"
#include "base/json/config.h"
#include "terrain/soil/calibration.h"

namespace gonogo::terrain {
namespace {

/// 1: without "response"; 2: without "shape", of spheres; 3: friction angles by simple shear; 4: one loosest packing
/// for all contact levels.
const std::vector<std::string> kSchemas = {"gonogo/calibration/1", "gonogo/calibration/2", "gonogo/calibration/3",
                                           "gonogo/calibration/4", "gonogo/calibration/5"};

/// One row for each contact level and packing, in that order.
std::vector<SoilResponse> read_responses(const Config& file, const Calibration& c, bool by_shear) {
  if (c.packing.empty()) file.fail("packing", "needs at least two packings");
  std::vector<SoilResponse> rows;
  for (const Config& row : file.objects("response")) {
    SoilResponse r;
    r.contact = rows.size() / c.packing.size();
    r.packing = rows.size() % c.packing.size();
    if (row.integer("contact") != std::int64_t(r.contact) || row.integer("packing") != std::int64_t(r.packing))
      row.fail("", "rows must go through the packings of each contact level in turn");
    if (by_shear) {
      row.number("friction_angle_deg", {0, 89});
      row.number("peak_friction_angle_deg", {0, 89});
    } else {
      r.friction_angle = row.number("friction_angle_deg", {1e-3, 89});
      r.friction_angle_error = row.number("friction_angle_error_deg", {0, 89});
      r.steady_friction_angle = row.number("steady_friction_angle_deg", {0, 89});
    }
    r.cohesion_gain = row.number("cohesion_gain", {-100, 100});
    r.sinkage_modulus = row.number("sinkage_modulus_N_per_m_n_plus_2", {0, 1e15});
    r.sinkage_modulus_error = row.number("sinkage_modulus_error", {0, 1e15});
    r.sinkage_exponent = row.number("sinkage_exponent", {-10, 10});
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
  j["schema"] = c.contact.front().loosest_solid_fraction > 0 ? kSchemas[4] : kSchemas[3];
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
    row["cohesion_gain"] = r.cohesion_gain;
    row["sinkage_modulus_N_per_m_n_plus_2"] = r.sinkage_modulus;
    row["sinkage_modulus_error"] = r.sinkage_modulus_error;
    row["sinkage_exponent"] = r.sinkage_exponent;
    j["response"].push_back(row);
  }
  j["cohesion_gain"] = c.cohesion_gain;
  j["cohesion_gain_error"] = c.cohesion_gain_error;
  j["provenance"] = c.provenance;
  write_file_atomically(path, j.dump(2) + "\n");
}

Calibration read_calibration(const std::filesystem::path& path) {
  const Config file = Config::read(path);
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
  if (version == 2 || (version >= 3 && file.has("response"))) c.response = read_responses(file, c, version <= 3);
  c.cohesion_gain = file.number("cohesion_gain", {1e-6, 100});
  c.cohesion_gain_error = file.number("cohesion_gain_error", {0, 100});
  file.finish();
  if (c.packing.size() < 2 || c.contact.size() < 2) file.fail("", "needs at least two packings and two contact levels");
  return c;
}

}  // namespace gonogo::terrain
