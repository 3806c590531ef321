#include "pipeline/map/region/read_soil.h"

#include <algorithm>

#include "base/error.h"
#include "base/nearest.h"
#include "base/units.h"
#include "pipeline/map/region/named_soil.h"
#include "terrain/soil/texture.h"

namespace gonogo::map {
namespace {

constexpr int kMixtureDraws = 96;  // points of a mixture: 8 textures of 3 moistures get 4 each

SoilSample read_sample(const Config& config) {
  SoilSample sample;
  sample.source = config.text("source");
  if (config.has("water_percent")) sample.water_percent = config.number("water_percent", {0, 1000});
  if (config.has("cone_index_kPa")) sample.cone_index = 1e3 * config.number("cone_index_kPa", {0, 10000});
  for (const campaign::Variable& variable : campaign::contract().variables) {
    if (variable.name == "slope_along" || variable.name == "slope_across" || !config.has(variable.name)) continue;
    const double value = config.number(variable.name, {variable.minimum, variable.maximum});
    sample.values[variable.name] = {Spread::Kind::fixed, value, value, sample.source};
  }
  if (sample.values.empty()) config.fail("", "holds no variable; give for example friction_angle and cohesion");
  config.finish();
  return sample;
}

}  // namespace

std::string read_texture(const Config& config) {
  return config.has("texture") ? config.choice("texture", terrain::usda_textures()) : "";
}

void take_named(const Config& config, const std::string& key, Soil& soil) {
  if (config.has("samples")) config.fail("samples", "and \"" + key + "\" are both given; keep one of them");
  Soil named;
  try {
    named = named_soil(config.text(key), "");
  } catch (const InputError& error) {
    config.fail(key, error.what());
  }
  soil.samples = named.samples;
  soil.draws = named.draws;
  if (soil.texture.empty()) soil.texture = named.texture;
}

namespace {

/// Samples of several textures, each as often as its parts.
void take_mixture(const Config& config, Soil& soil) {
  if (config.has("samples") || config.has("like"))
    config.fail("mixture", "and samples or like are both given; keep one of them");
  const Config parts = config.object("mixture");
  int sum = 0;
  for (const auto& [texture, count] : parts.json().members()) {
    const auto& known = terrain::usda_textures();
    if (std::find(known.begin(), known.end(), texture) == known.end())
      parts.fail(texture, "is no USDA texture; did you mean \"" + nearest_word(texture, known) + "\"?");
    const auto times = parts.integer(texture, {1, 64});
    const Soil named = named_soil(texture, "");
    for (int k = 0; k < times; ++k) soil.samples.insert(soil.samples.end(), named.samples.begin(), named.samples.end());
    sum += int(times);
  }
  if (sum < 1 || sum > 64) config.fail("mixture", "has " + std::to_string(sum) + " parts, allowed are 1 to 64");
  parts.finish();
  soil.draws = std::max(1, kMixtureDraws / int(soil.samples.size()));
}

}  // namespace

Soil read_soil(const Config& config) {
  Soil soil;
  soil.code = int(config.integer("code", {0, 65535}));
  soil.name = config.text("name");
  soil.note = config.text_or("note", "");
  soil.texture = read_texture(config);
  if (config.has("like")) take_named(config, "like", soil);
  if (config.has("mixture")) take_mixture(config, soil);
  if (config.has("samples"))
    for (const Config& sample : config.objects("samples")) soil.samples.push_back(read_sample(sample));
  if (const auto values = config.object_if("values")) soil.values = read_spreads(*values);
  config.finish();
  return soil;
}

Soil read_road_soil(const Config& config, int code, const std::string& name) {
  Soil soil{.code = code, .name = name, .note = "", .texture = "", .samples = {}, .values = {}};
  if (config.has("speed_km_h")) soil.max_speed = config.number("speed_km_h", {1, 300}) / kKmPerHour;
  if (config.text("soil") != "paved") {
    take_named(config, "soil", soil);
    return soil;
  }
  soil.texture = "sand";  // carries: no cone index is asked for
  const std::pair<const char*, double> values[] = {{"friction_angle", 50}, {"cohesion", 100}, {"relative_density", 1}};
  for (const auto& [variable, value] : values) soil.values[variable] = {Spread::Kind::fixed, value, value, "paved"};
  return soil;
}

}  // namespace gonogo::map
