#include "pipeline/map/region/region.h"

#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/campaign/study/study.h"
#include "terrain/soil/soil.h"

namespace gonogo::map {

namespace {

RegionRaster read_raster(const Config& config, const std::string& role) {
  RegionRaster raster;
  if (config.has("files")) {
    for (const std::string& file : config.texts("files"))
      raster.files.file.push_back(config.file().parent_path() / file);
    if (raster.files.file.empty()) config.fail("files", "names no file; give the tiles of the raster");
  } else {
    raster.files = config.path("file");
  }
  raster.source = config.text("source");
  raster.licence = config.text("licence");
  if (role == "cone_index") raster.unit = config.choice("unit", {"psi", "kPa"}) == "psi" ? kPsi : 1e3;
  if (role == "elevation") {
    if (config.has("unit")) raster.heights.unit = config.choice("unit", {"m", "ft", "us-ft"});
    if (config.has("flat")) raster.heights.flat_is_ground = config.choice("flat", {"unknown", "ground"}) == "ground";
  }
  if (role == "elevation" && config.has("error_m")) {
    raster.error = config.number("error_m", {0, 1000});
    raster.error_correlation = config.number_or("error_correlation", 0, {0, 0.9999});
    config.text("error_source");
  }
  config.text_or("note", "");
  config.finish();
  return raster;
}

void read_rasters(const Config& config, Region& region) {
  bool has_elevation = false;
  for (const Config& entry : config.objects("rasters")) {
    const std::string role = entry.choice("role", {"elevation", "soil_class", "land_cover", "moisture", "cone_index"});
    std::optional<RegionRaster>& place = role == "soil_class"   ? region.soil_class
                                         : role == "land_cover" ? region.land_cover
                                         : role == "moisture"   ? region.moisture
                                                                : region.cone_index;
    const bool elevation = role == "elevation";
    if (elevation ? has_elevation : place.has_value()) entry.fail("role", "is given twice; keep one raster");
    if (elevation) {
      region.elevation = read_raster(entry, role);
      has_elevation = true;
    } else {
      place = read_raster(entry, role);
    }
  }
  if (!has_elevation) config.fail("rasters", "no raster has the role \"elevation\"; add one");
}

LandRule read_land_rule(const Config& config) {
  LandRule rule{.code = int(config.integer("code", {0, 65535})), .name = config.text("name")};
  const std::string verdict = config.choice("verdict", {"soil", "no_go", "unknown"});
  config.text_or("note", "");
  if (verdict != "soil") {
    rule.verdict = verdict == "no_go" ? campaign::Verdict::no_go : campaign::Verdict::unknown;
    const std::string reason = config.choice("reason", {"water", "vegetation", "built_up"});
    rule.reason = reason == "water"        ? campaign::Reason::water
                  : reason == "vegetation" ? campaign::Reason::vegetation
                                           : campaign::Reason::built_up;
  }
  config.finish();
  return rule;
}

void read_land(const Config& config, Region& region) {
  std::set<int> codes;
  if (config.has("land_cover"))
    for (const Config& entry : config.objects("land_cover")) {
      region.land.push_back(read_land_rule(entry));
      if (!codes.insert(region.land.back().code).second) entry.fail("code", "is given twice; keep one rule");
    }
  if (region.land_cover.has_value() == region.land.empty())
    config.fail("land_cover", region.land.empty()
                                  ? "missing; say what the codes of the land_cover raster mean"
                                  : "no raster has the role \"land_cover\"; add one or remove the rules");
}

void read_moisture(const Config& config, Region& region) {
  if (const auto states = config.object_if("moisture")) {
    states->text("source");
    for (const char* name : {"dry", "moist", "wet"}) {
      if (!states->has(name)) continue;
      const std::vector<double> range = states->numbers(name, {0, 1000});
      if (range.size() != 2 || !(range[0] < range[1])) states->fail(name, "expected [min, max] percent of water");
      region.moistures.push_back({name, range[0], range[1]});
    }
    states->finish();
  }
  if (region.moisture && region.moistures.empty())
    config.fail("moisture", "missing; say from how much water [percent] on a soil is dry, moist or wet");
}

/// A cone index that holds everywhere.
void read_cone_index(const Config& config, Region& region) {
  const auto index = config.object_if("cone_index");
  if (!index) return;
  if (region.cone_index) config.fail("cone_index", "and a raster cone_index are both given; keep one of them");
  const double unit = index->choice("unit", {"psi", "kPa"}) == "psi" ? kPsi : 1e3;
  region.cone_index_everywhere = unit * index->number("fixed", {0, kMaxConeIndex / unit});
  index->text("source");
  index->finish();
}

void read_grid(const Config& config, Region& region) {
  const auto grid = config.object_if("grid");
  if (!grid) return;
  region.grid.crs = grid->text_or("crs", "");
  region.grid.cell_size = grid->number_or("cell_m", 0, {0.01, 100000});
  grid->finish();
}

void read_obstacles(const Config& config, Region& region) {
  if (!config.has("obstacles")) return;
  for (const Config& entry : config.objects("obstacles")) {
    Obstacle o = read_obstacle(entry);
    if (o.kind == ObstacleKind::road) {
      if (region.soils.empty())
        region.soils.push_back(
            {.code = 0, .name = "all soils", .note = "", .texture = "", .samples = {}, .values = {}});
      o.road_soil = kRoadCode + int(region.obstacles.size());
      region.soils.push_back(read_road_soil(entry, o.road_soil, o.name));
      if (entry.text("soil") != "paved") region.soil_text += soil_hash(entry.text("soil")) + " ";
    }
    entry.finish();
    region.obstacles.push_back(std::move(o));
  }
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
  read_cone_index(config, region);
  read_grid(config, region);
  if (config.has("gravity")) region.gravity = config.number("gravity", campaign::kGravityRange);
  read_land(config, region);
  read_moisture(config, region);
  if (config.has("soils")) {
    std::set<int> codes;
    for (const Config& entry : config.objects("soils")) {
      region.soils.push_back(read_soil(entry));
      if (entry.has("mixture")) region.soil_text = soil_hash("sand") + " ";
      if (entry.has("like")) region.soil_text += soil_hash(entry.text("like")) + " ";
      if (!codes.insert(region.soils.back().code).second) entry.fail("code", "is given twice; keep one soil");
    }
  }
  if (region.soil_class.has_value() == region.soils.empty())
    config.fail("soils", region.soils.empty() ? "missing; say what the codes of the soil_class raster mean"
                                              : "no raster has the role \"soil_class\"; add one or remove the soils");
  region.texture = read_texture(config);
  if (config.has("soil")) {
    if (region.soil_class) config.fail("soil", "and a raster soil_class are both given; keep one of them");
    Soil soil{
        .code = 0, .name = config.text("soil"), .note = "", .texture = region.texture, .samples = {}, .values = {}};
    take_named(config, "soil", soil);
    region.soil_text = soil_hash(config.text("soil"));
    region.soils.push_back(std::move(soil));
  }
  read_obstacles(config, region);
  if (const auto values = config.object_if("values")) region.values = read_spreads(*values);
  config.finish();
  return region;
}

std::vector<LandRule> land_rules(const Region& region) {
  std::vector<LandRule> rules = region.land;
  rules.push_back({-1, "land cover not known", campaign::Verdict::unknown, campaign::Reason::land_unknown});
  rules.push_back({-1, "measured cone index below VCI1", campaign::Verdict::no_go, campaign::Reason::soft_soil});
  rules.push_back({-1, "exactly flat: water or a void", campaign::Verdict::unknown, campaign::Reason::land_unknown});
  for (const Obstacle& o : region.obstacles) {
    rules.push_back({-1, o.name, campaign::Verdict::no_go, reason_of(o.kind, Crossing::no_go)});
    rules.push_back({-1, o.name + ", not known", campaign::Verdict::unknown, reason_of(o.kind, Crossing::unknown)});
  }
  return rules;
}

std::vector<SoilSample> samples_in(const Soil& soil, const MoistureState& state) {
  std::vector<SoilSample> samples;
  for (const SoilSample& sample : soil.samples)
    if (sample.water_percent ? *sample.water_percent >= state.low && *sample.water_percent < state.high
                             : sample.moisture.empty() || sample.moisture == state.name)
      samples.push_back(sample);
  return samples;
}

namespace {

constexpr double kMediumDense = 0.5;  // where the relative density is not known [-]

/// The point with the friction angle and cohesion that its soil has in triaxial compression.
void make_triaxial(const Region& region, const terrain::AngleMeaning& meaning, std::vector<double>& point) {
  const campaign::Contract& c = campaign::contract();
  double &angle = point[c.variable_index("friction_angle")], &cohesion = point[c.variable_index("cohesion")];
  const double density = point[c.variable_index("relative_density")];
  const terrain::MacroscopicSoil given{.friction_angle = angle,
                                       .cohesion = cohesion,
                                       .bulk_density = 0,
                                       .relative_density = std::isnan(density) ? kMediumDense : density,
                                       .meaning = meaning};
  const terrain::MacroscopicSoil soil =
      region.table ? terrain::as_triaxial(*region.table, given) : terrain::as_triaxial(given);
  angle = soil.friction_angle;
  cohesion = soil.cohesion;
}

}  // namespace

std::vector<std::vector<double>> soil_points(const Region& region, const Soil& soil, const Spreads& overriding,
                                             int draws) {
  std::vector<SoilSample> samples = soil.samples;
  if (samples.empty()) samples.emplace_back();
  std::vector<std::vector<double>> points;
  std::map<int, int> samples_of;  // by alternative
  for (const SoilSample& sample : samples) {
    Spreads spreads = overriding;  // insert() keeps what is already there
    spreads.insert(sample.values.begin(), sample.values.end());
    spreads.insert(soil.values.begin(), soil.values.end());
    spreads.insert(region.values.begin(), region.values.end());
    const auto angle = spreads.find("friction_angle");
    const bool converts = angle != spreads.end() && angle->second.kind != Spread::Kind::unknown &&
                          !angle->second.meaning.is_triaxial_peak();
    const int shift = soil.draws > 0 ? samples_of[sample.alternative]++ : 0;
    for (auto& point : spread_points(spreads, soil.draws > 0 ? soil.draws : draws, shift)) {
      if (converts) make_triaxial(region, angle->second.meaning, point);
      points.push_back(std::move(point));
    }
  }
  return points;
}

namespace {

constexpr double kTolerance = 0.02;

/// "the Moon", or the radius of a body that has no name here.
std::string body_text(double radius) {
  const auto body = terrain::body_of_radius(radius);
  return body ? body->with_article : line("a body with a radius of %.0f km", radius / 1e3);
}

}  // namespace

std::string gravity_text(double gravity) { return line("%.4g m/s2", gravity); }

bool is_same_gravity(double a, double b) { return std::abs(a / b - 1) <= kTolerance; }

double ground_gravity(const Region& region, double body_radius) {
  const auto body = terrain::body_of_radius(body_radius);
  const std::string place = region.file.string() + ": gravity: ";
  if (!region.gravity) {
    if (body) return body->gravity;
    throw InputError(place + "is missing, and the elevation lies on " + body_text(body_radius) +
                     ", which this program does not know; give a region file with \"gravity\" [m/s2]");
  }
  if (body && !is_same_gravity(*region.gravity, body->gravity))
    throw InputError(place + "is " + gravity_text(*region.gravity) + ", and the elevation lies on " +
                     body_text(body_radius) + ", which has " + gravity_text(body->gravity) +
                     "; leave it out, or give ground of that gravity");
  return *region.gravity;
}

void require_gravity(const Region& region, double body_radius, double of_trials) {
  const double ground = ground_gravity(region, body_radius);
  if (is_same_gravity(ground, of_trials)) return;
  throw InputError(region.elevation.files.name() + ": lies on " + body_text(body_radius) + " with a gravity of " +
                   gravity_text(ground) + ", and the trials of the model had " + gravity_text(of_trials) +
                   line("; give a model of trials whose study says \"gravity\": %.4g, or ground of %s", ground,
                        gravity_text(of_trials).c_str()));
}

}  // namespace gonogo::map
