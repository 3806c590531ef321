#include "pipeline/map/region.h"

#include <set>

namespace gonogo::pipeline {
namespace {

RegionRaster read_raster(const Config& config, bool elevation) {
  RegionRaster raster;
  raster.file = config.path("file");
  raster.source = config.text("source");
  raster.licence = config.text("licence");
  if (elevation && config.has("error_m")) {
    raster.error = config.number("error_m", {0, 1000});
    raster.error_correlation = config.number_or("error_correlation", 0, {0, 0.9999});
    config.text("error_source");
  }
  config.text_or("note", "");
  config.finish();
  return raster;
}

SoilSample read_sample(const Config& config) {
  SoilSample sample;
  sample.source = config.text("source");
  config.number_or("water_percent", 0, {0, 1000});
  for (const Variable& variable : contract().variables) {
    if (variable.name == "slope_along" || variable.name == "slope_across" || !config.has(variable.name)) continue;
    const double value = config.number(variable.name, {variable.minimum, variable.maximum});
    sample.values[variable.name] = {Spread::Kind::fixed, value, value, sample.source};
  }
  if (sample.values.empty()) config.fail("", "holds no variable; give for example friction_angle and cohesion");
  config.finish();
  return sample;
}

Soil read_soil(const Config& config) {
  Soil soil;
  soil.code = int(config.integer("code", {0, 65535}));
  soil.name = config.text("name");
  soil.note = config.text_or("note", "");
  if (config.has("samples"))
    for (const Config& sample : config.objects("samples")) soil.samples.push_back(read_sample(sample));
  if (const auto values = config.object_if("values")) soil.values = read_spreads(*values);
  config.finish();
  return soil;
}

void read_rasters(const Config& config, Region& region) {
  bool has_elevation = false;
  for (const Config& entry : config.objects("rasters")) {
    const bool elevation = entry.choice("role", {"elevation", "soil_class"}) == "elevation";
    if (elevation ? has_elevation : region.soil_class.has_value())
      entry.fail("role", "is given twice; keep one raster");
    if (elevation) {
      region.elevation = read_raster(entry, true);
      has_elevation = true;
    } else {
      region.soil_class = read_raster(entry, false);
    }
  }
  if (!has_elevation) config.fail("rasters", "no raster has the role \"elevation\"; add one");
}

}  // namespace

Region read_region(const std::filesystem::path& path) {
  const Config config = Config::read(path);
  config.choice("schema", {"gonogo/region/1"});
  Region region;
  region.file = path;
  region.name = config.text("region");
  region.about = config.text_or("about", "");
  read_rasters(config, region);
  if (config.has("soils")) {
    std::set<int> codes;
    for (const Config& entry : config.objects("soils")) {
      region.soils.push_back(read_soil(entry));
      if (!codes.insert(region.soils.back().code).second) entry.fail("code", "is given twice; keep one soil");
    }
  }
  if (region.soil_class.has_value() == region.soils.empty())
    config.fail("soils", region.soils.empty() ? "missing; say what the codes of the soil_class raster mean"
                                              : "no raster has the role \"soil_class\"; add one or remove the soils");
  if (const auto values = config.object_if("values")) region.values = read_spreads(*values);
  config.finish();
  return region;
}

std::vector<std::vector<double>> soil_points(const Region& region, const Soil& soil, const Spreads& overriding,
                                             int draws) {
  std::vector<SoilSample> samples = soil.samples;
  if (samples.empty()) samples.emplace_back();
  std::vector<std::vector<double>> points;
  for (const SoilSample& sample : samples) {
    Spreads spreads = overriding;  // insert() keeps what is already there
    spreads.insert(sample.values.begin(), sample.values.end());
    spreads.insert(soil.values.begin(), soil.values.end());
    spreads.insert(region.values.begin(), region.values.end());
    for (auto& point : spread_points(spreads, draws)) points.push_back(std::move(point));
  }
  return points;
}

}  // namespace gonogo::pipeline
