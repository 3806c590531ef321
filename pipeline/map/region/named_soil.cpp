#include "pipeline/map/region/named_soil.h"

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "base/hash.h"
#include "base/line.h"
#include "base/nearest.h"
#include "base/shipped.h"
#include "terrain/soil/soil_file.h"
#include "terrain/soil/texture.h"

namespace gonogo::map {
namespace fs = std::filesystem;
namespace {

constexpr int kDraws = 64;       // points of a soil that is named
constexpr int kDrawsOfEach = 4;  // of each of the textures that an unnamed soil may have

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_texture(const std::string& name) {
  const auto& all = terrain::usda_textures();
  return std::find(all.begin(), all.end(), name) != all.end();
}

/// "sandy loam, wet" is sandy loam with the moisture wet.
struct NameAndMoisture {
  std::string name, moisture;
};

NameAndMoisture split(const std::string& name, const std::string& moisture) {
  for (const std::string word : {"dry", "moist", "wet"}) {
    const std::string end = ", " + word;
    const bool ends = name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
    if (!ends) continue;
    if (!moisture.empty() && moisture != word)
      throw InputError(line("\"%s\" is %s, and the moisture %s is asked for; give one of them", name.c_str(),
                            word.c_str(), moisture.c_str()));
    return {name.substr(0, name.size() - end.size()), word};
  }
  return {name, moisture};
}

fs::path usda_file() { return shipped_file("soils", "soil", "usda"); }

Spread spread_of(const terrain::SoilValue& value) {
  const auto kind = value.fixed() ? Spread::Kind::fixed : Spread::Kind::range;
  return {kind, value.low, value.high, value.source.empty() ? value.no_source : value.source};
}

SoilSample sample_of(const terrain::SoilState& state) {
  SoilSample sample;
  sample.values["friction_angle"] = spread_of(state.friction_angle);
  sample.values["cohesion"] = spread_of(state.cohesion);
  sample.values["relative_density"] = spread_of(state.relative_density);
  sample.source = state.name;
  sample.water_percent = state.water_percent;
  sample.texture = state.texture;
  sample.moisture = state.moisture;
  return sample;
}

bool is_of(const terrain::SoilState& state, const std::string& moisture) {
  return moisture.empty() || state.moisture == moisture;
}

/// The states of one texture at this moisture.
Soil texture_soil(const terrain::SoilFile& usda, const std::string& texture, const std::string& moisture) {
  Soil soil;
  soil.name = texture + (moisture.empty() ? "" : ", " + moisture);
  soil.texture = texture;
  soil.draws = kDraws;
  for (const terrain::SoilState& state : usda.states)
    if (state.texture == texture && is_of(state, moisture)) soil.samples.push_back(sample_of(state));
  if (soil.samples.size() > 1) soil.draws = kDraws / int(soil.samples.size());
  return soil;
}

fs::path find_soil_file(const std::string& name) {
  if (fs::is_regular_file(name)) return name;
  std::vector<std::string> names = terrain::usda_textures();
  for (const fs::path& folder : shipped_folders("soils"))
    for (const std::string& file : shipped_names(folder, "calibration")) {
      if (file == name) return folder / (file + ".json");
      if (std::find(names.begin(), names.end(), file) == names.end()) names.push_back(file);
    }
  throw InputError("\"" + name + "\" is no soil (did you mean \"" + nearest_word(lower(name), names) +
                   "\"?); name a USDA texture, a soil of configs/soils, a soil file, or a raster of USDA textures: " +
                   join_words(names));
}

}  // namespace

Soil named_soil(const std::string& text, const std::string& asked) {
  const auto [name, moisture] = split(text, asked);
  if (is_texture(lower(name))) return texture_soil(terrain::read_soil(usda_file()), lower(name), moisture);
  const fs::path path = find_soil_file(name);
  const terrain::SoilFile file = terrain::read_soil(path);
  Soil soil;
  soil.name = file.name + (moisture.empty() ? "" : ", " + moisture);
  soil.note = file.about;
  std::vector<std::string> states;
  for (const terrain::SoilState& state : file.states) {
    states.push_back(state.name);
    if (is_of(state, moisture)) soil.samples.push_back(sample_of(state));
  }
  if (soil.samples.empty())
    throw InputError(path.string() + ": no state of this soil is " + moisture + "; it has: " + join_words(states) +
                     "; leave the moisture open to take all of them");
  soil.draws = std::max(1, kDraws / int(soil.samples.size()));
  return soil;
}

Soil soil_not_given(const std::string& moisture) {
  Soil soil;
  soil.name = "soil not given: any USDA texture" + (moisture.empty() ? ", dry, moist or wet" : ", " + moisture);
  soil.given = false;
  soil.draws = kDrawsOfEach;
  for (const terrain::SoilState& state : terrain::read_soil(usda_file()).states)
    if (is_of(state, moisture)) soil.samples.push_back(sample_of(state));
  return soil;
}

std::vector<Soil> texture_soils(const std::vector<std::string>& class_names, const std::string& moisture,
                                const std::string& where) {
  const terrain::SoilFile usda = terrain::read_soil(usda_file());
  std::vector<std::string> names = class_names;
  if (names.empty()) {
    names = terrain::usda_texture_codes();
    names.insert(names.begin(), "");
  }
  std::vector<Soil> soils;
  for (std::size_t code = 0; code < names.size(); ++code) {
    if (!is_texture(lower(names[code]))) continue;
    soils.push_back(texture_soil(usda, lower(names[code]), moisture));
    soils.back().code = int(code);
  }
  if (soils.empty())
    throw InputError(where + ": names its classes \"" + class_names.front() +
                     "\", ... and none of them is a USDA "
                     "texture; say what they mean in a region file (docs/map.md)");
  return soils;
}

std::string soil_hash(const std::string& text) {
  const std::string name = split(text, "").name;
  return file_hash(name.empty() || is_texture(lower(name)) ? usda_file() : find_soil_file(name));
}

}  // namespace gonogo::map
