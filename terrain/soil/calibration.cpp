#include "terrain/soil/calibration.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/file.h"
#include "base/json/config.h"

namespace gonogo::terrain {

AngleRange reachable_angles(const Calibration& c) {
  return {c.contact.front().friction_angle, c.contact.back().friction_angle};
}

std::size_t packing_level(const Calibration& c, double density) {
  std::size_t best = 0;
  for (std::size_t p = 1; p < c.packing.size(); ++p)
    if (std::fabs(c.packing[p].relative_density - density) < std::fabs(c.packing[best].relative_density - density))
      best = p;
  return best;
}

sim::PairLaw contact_law(const Calibration& c, const MacroscopicSoil& soil) {
  const AngleRange range = reachable_angles(c);
  if (!(soil.friction_angle >= range.lowest && soil.friction_angle <= range.highest)) {
    std::ostringstream text;
    text << "soil: friction angle " << soil.friction_angle << " deg is outside what grains of " << c.grain_diameter
         << " m reach; choose one between " << range.lowest << " and " << range.highest << " deg";
    throw InputError(text.str());
  }
  std::size_t k = 1;
  while (k + 1 < c.contact.size() && c.contact[k].friction_angle < soil.friction_angle) ++k;
  const ContactLevel &a = c.contact[k - 1], &b = c.contact[k];
  const double share = (soil.friction_angle - a.friction_angle) / std::max(1e-9, b.friction_angle - a.friction_angle);
  const auto between = [&](double low, double high) { return (1 - share) * low + share * high; };
  return {Real(between(a.friction, b.friction)), Real(between(a.rolling_friction, b.rolling_friction)),
          Real(soil.cohesion / c.cohesion_gain)};
}

void write_calibration(const std::filesystem::path& path, const Calibration& c) {
  Json j;
  j["schema"] = "gonogo/calibration/1";
  j["grain_diameter_m"] = c.grain_diameter;
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
    j["contact"].push_back(row);
  }
  j["cohesion_gain"] = c.cohesion_gain;
  j["cohesion_gain_error"] = c.cohesion_gain_error;
  j["provenance"] = c.provenance;
  write_file_atomically(path, j.dump(2) + "\n");
}

Calibration read_calibration(const std::filesystem::path& path) {
  const Config file = Config::read(path);
  file.choice("schema", {"gonogo/calibration/1"});
  Calibration c;
  c.grain_diameter = file.number("grain_diameter_m", {1e-5, 1});
  if (file.has("provenance")) c.provenance = file.json().at("provenance");
  for (const Config& row : file.objects("packing"))
    c.packing.push_back({row.number("settle_friction", {0, 10}), row.number("solid_fraction", {0.3, 0.75}),
                         row.number("relative_density", {0, 1})});
  for (const Config& row : file.objects("contact"))
    c.contact.push_back({row.number("friction", {0, 10}), row.number("rolling_friction", {0, 10}),
                         row.number("friction_angle_deg", {0, 89}), row.number("friction_angle_error_deg", {0, 89}),
                         row.number("cohesion_gain", {-100, 100}), row.number("cohesion_gain_error", {0, 100})});
  c.cohesion_gain = file.number("cohesion_gain", {1e-6, 100});
  c.cohesion_gain_error = file.number("cohesion_gain_error", {0, 100});
  file.finish();
  if (c.packing.size() < 2 || c.contact.size() < 2) file.fail("", "needs at least two packings and two contact levels");
  return c;
}

}  // namespace gonogo::terrain
