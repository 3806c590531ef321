#include "pipeline/map/soils/soil.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/map/soils/soil_of_numbers.h"
#include "terrain/soil/bearing.h"
#include "terrain/soil/soil.h"

namespace gonogo::map {

namespace {

terrain::AngleMeaning read_meaning(const Config& config) {
  terrain::AngleMeaning meaning{.assumed = !config.has("test")};
  if (meaning.assumed) return meaning;
  meaning.test = terrain::strength_test_of(
      config.choice("test", {"triaxial", "direct_shear", "ring_shear", "plane_strain", "repose"}));
  if (meaning.test == terrain::StrengthTest::repose) return meaning;
  meaning.stage =
      config.choice("stage", {"peak", "residual"}) == "peak" ? terrain::Stage::peak : terrain::Stage::residual;
  meaning.dilation = config.number_or("dilation_deg", 0, {-20, 40});
  return meaning;
}

Spread read_spread(const Config& config, const campaign::Variable& variable) {
  Spread spread;
  if (int(config.has("fixed")) + int(config.has("range")) + int(config.has("unknown")) != 1)
    config.fail("", "expected exactly one of \"fixed\", \"range\" and \"unknown\"");
  if (config.has("unknown")) {
    spread.source = config.text("unknown");
  } else if (config.has("fixed")) {
    spread.kind = Spread::Kind::fixed;
    spread.low = spread.high = campaign::read_value(config, "fixed", variable);
    spread.source = config.text("source");
  } else {
    const std::vector<double> range = config.numbers("range", {variable.minimum, variable.maximum});
    if (range.size() != 2 || !(range[0] < range[1])) config.fail("range", "expected [low, high]");
    spread = {Spread::Kind::range, range[0], range[1], config.text("source")};
  }
  if (variable.name == "friction_angle") spread.meaning = read_meaning(config);
  config.finish();
  return spread;
}

/// Digits of `index` in `base`, mirrored at the point (van der Corput).
double radical_inverse(int index, int base) {
  double value = 0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) value += digit * (index % base);
  return value;
}

}  // namespace

Spreads read_spreads(const Config& config) {
  Spreads spreads;
  for (const auto& [name, member] : config.members()) {
    if (name == "slope_along" || name == "slope_across")
      config.fail(name, "slopes come from the elevation raster; remove this key");
    spreads[name] = read_spread(member, campaign::contract().variables[campaign::contract().variable_index(name)]);
  }
  return spreads;
}

std::vector<std::vector<double>> spread_points(const Spreads& spreads, int draws, int shift) {
  constexpr std::array<int, 10> kPrimes = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29};
  const auto& variables = campaign::contract().variables;
  int ranges = 0;
  for (const auto& [name, spread] : spreads) ranges += spread.kind == Spread::Kind::range;
  if (ranges > int(kPrimes.size()))
    throw InputError("more ranges than the map can sample; fix some of these variables");
  std::vector<std::vector<double>> points(
      std::size_t(ranges > 0 ? draws : 1),
      std::vector<double>(variables.size(), std::numeric_limits<double>::quiet_NaN()));
  int dimension = 0;
  for (std::size_t v = 0; v < variables.size(); ++v) {
    if (campaign::is_task_variable(variables[v]))
      for (std::vector<double>& point : points) point[v] = 0;
    const auto found = spreads.find(variables[v].name);
    if (found == spreads.end() || found->second.kind == Spread::Kind::unknown) continue;
    const Spread& spread = found->second;
    const bool ranged = spread.kind == Spread::Kind::range;
    for (int i = 0; i < int(points.size()); ++i) {
      double share = !ranged          ? 0
                     : dimension == 0 ? (i + 0.5) / draws
                                      : radical_inverse(i + 1, kPrimes[std::size_t(dimension) - 1]);
      if (ranged && shift > 0)
        share = std::fmod(share + shift * std::sqrt(double(kPrimes[std::size_t(dimension)])), 1.0);
      points[std::size_t(i)][v] = spread.low + (spread.high - spread.low) * share;
    }
    dimension += ranged;
  }
  return points;
}

namespace {

constexpr int kMixtureDraws = 96;  // points of a mixture: 8 textures of 3 moistures get 4 each

SoilSample read_sample(const Config& config) {
  SoilSample sample;
  sample.source = config.text("source");
  if (config.has("water_percent")) sample.water_percent = config.number("water_percent", {0, 1000});
  if (config.has("cone_index_kPa")) sample.cone_index = 1e3 * config.number("cone_index_kPa", {0, 10000});
  for (const campaign::Variable& variable : campaign::contract().variables) {
    if (variable.name == "slope_along" || variable.name == "slope_across" || !config.has(variable.name)) continue;
    const double value = campaign::read_value(config, variable.name, variable);
    sample.values[variable.name] = {Spread::Kind::fixed, value, value, sample.source};
  }
  if (const auto angle = sample.values.find("friction_angle"); angle != sample.values.end())
    angle->second.meaning = read_meaning(config);
  if (sample.values.empty()) config.fail("", "holds no variable; give for example friction_angle and cohesion");
  config.finish();
  return sample;
}

}  // namespace

std::string read_texture(const Config& config) {
  if (!config.has("texture")) return "";
  std::vector<std::string> known = terrain::usda_textures();
  known.insert(known.end(), terrain::uscs_classes().begin(), terrain::uscs_classes().end());
  return config.choice("texture", known);
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
  soil.doubts = named.doubts;
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

namespace fs = std::filesystem;
namespace {

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

/// `alternative`: see SoilSample.
SoilSample sample_of(const terrain::SoilState& state, std::size_t alternative) {
  SoilSample sample;
  sample.alternative = int(alternative);
  sample.values["friction_angle"] = spread_of(state.friction_angle);
  sample.values["friction_angle"].meaning = state.meaning;
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

/// The states of one texture, or of one class of the USCS, at this moisture.
Soil texture_soil(const terrain::SoilFile& usda, const std::string& texture, const std::string& moisture) {
  Soil soil{.name = texture + (moisture.empty() ? "" : ", " + moisture), .texture = texture, .draws = kSoilDraws};
  for (const terrain::SoilState& state : usda.states)
    if (state.texture == texture && is_of(state, moisture))
      soil.samples.push_back(sample_of(state, soil.samples.size()));
  return soil;
}

std::string upper(std::string text) {
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

bool is_uscs(const std::string& name) {
  const auto& all = terrain::uscs_classes();
  return std::find(all.begin(), all.end(), upper(name)) != all.end();
}

void refuse_organic(const std::string& name) {
  const std::string symbol = upper(name);
  if (symbol == "PT" || symbol == "OH" || symbol == "OL")
    throw InputError("\"" + name + "\" is an organic class of the USCS: no trial has fibres or peat, so that no map " +
                     "answers for it; give a measured cone index and the inorganic class beneath, or one of " +
                     join_words(terrain::uscs_classes()));
}

fs::path uscs_file() { return shipped_file("soils", "soil", "uscs"); }

fs::path find_soil_file(const std::string& name) {
  if (fs::is_regular_file(name)) return name;
  refuse_organic(name);
  std::vector<std::string> names = terrain::usda_textures();
  for (const fs::path& folder : shipped_folders("soils"))
    for (const std::string& file : shipped_names(folder, "calibration")) {
      if (file == name) return folder / (file + ".json");
      if (std::find(names.begin(), names.end(), file) == names.end()) names.push_back(file);
    }
  throw InputError("\"" + name + "\" is no soil (did you mean \"" + nearest_word(lower(name), names) +
                   "\"?); name a USDA texture, a class of the USCS (" + join_words(terrain::uscs_classes()) +
                   "), a soil of configs/soils, a soil file, or a raster of USDA textures: " + join_words(names));
}

}  // namespace

Soil named_soil(const std::string& text, const std::string& asked) {
  if (auto soil = soil_of_numbers(text)) return *soil;
  const auto [name, moisture] = split(text, asked);
  if (is_texture(lower(name))) return texture_soil(terrain::read_soil(usda_file()), lower(name), moisture);
  if (is_uscs(name)) return texture_soil(terrain::read_soil(uscs_file()), upper(name), moisture);
  const fs::path path = find_soil_file(name);
  const terrain::SoilFile file = terrain::read_soil(path);
  const bool like_a_texture = is_texture(lower(file.name));
  Soil soil{.name = file.name + (like_a_texture ? " of " + path.filename().string() : "") +
                    (moisture.empty() ? "" : ", " + moisture),
            .note = file.about};
  if (like_a_texture) soil.not_texture = path.filename().string();
  std::vector<std::string> states;
  for (const terrain::SoilState& state : file.states) {
    states.push_back(state.name);
    if (!is_of(state, moisture)) continue;
    soil.samples.push_back(sample_of(state, soil.samples.size()));
    if (const auto doubt = terrain::plates_against_strength(state)) soil.doubts.push_back(state.name + ": " + *doubt);
  }
  if (soil.samples.empty())
    throw InputError(path.string() + ": no state of this soil is " + moisture + "; it has: " + join_words(states) +
                     "; leave the moisture open to take all of them");
  soil.draws = kSoilDraws;
  return soil;
}

Soil soil_not_given(const std::string& moisture) {
  Soil soil;
  soil.name = "soil not given: any USDA texture" + (moisture.empty() ? ", dry, moist or wet" : ", " + moisture);
  soil.given = false;
  soil.draws = kSoilDraws;
  for (const terrain::SoilState& state : terrain::read_soil(usda_file()).states)
    if (is_of(state, moisture)) soil.samples.push_back(sample_of(state, soil.samples.size()));
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
  if (soil_of_numbers(text)) return content_hash(text);
  const std::string name = split(text, "").name;
  if (is_uscs(name)) return file_hash(uscs_file());
  return file_hash(name.empty() || is_texture(lower(name)) ? usda_file() : find_soil_file(name));
}

}  // namespace gonogo::map
