#include "pipeline/map/write/make_map.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/json/seal.h"
#include "base/progress.h"
#include "base/units.h"
#include "base/version.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/map/write/map_exports.h"
#include "pipeline/map/write/map_page.h"
#include "pipeline/map/write/map_tiles.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::map {

namespace fs = std::filesystem;
namespace {

constexpr const char* kRecordName = "map.json";
constexpr const char* kPageName = "index.html";
constexpr const char* kMakeAgain = "make the map again";
constexpr const char* kUnfinished = ".new";  // folder in the map's own where the next map grows

Json spreads_json(const Spreads& spreads) {
  Json json = Json::object();
  for (const auto& [name, spread] : spreads) {
    const bool unknown = spread.kind == Spread::Kind::unknown;
    json[name] = unknown ? Json::Object{{"unknown", spread.source}}
                         : Json::Object{{"range", Json::Array{spread.low, spread.high}}};
  }
  return json;
}

}  // namespace

std::string vehicle_text(const OutcomeModel& model) {
  const std::string kind = model.whole_vehicle ? "the vehicle" : "the quarter vehicle";
  return kind + (model.vehicle.empty() ? "" : " " + model.vehicle);
}

std::string map_title(const MapRequest& request) {
  return request.model.vehicle.empty() ? request.region.name : request.model.vehicle;
}

std::string conditions_text(const MapRequest& request) {
  const std::vector<Soil>& soils = request.region.soils;
  std::string text = soils.empty()       ? "soil by its ranges"
                     : soils.size() == 1 ? soils.front().name
                                         : std::to_string(soils.size()) + " soils";
  if (!request.rules.moisture.empty())
    text += ", " + request.rules.moisture;
  else if (request.region.moisture)
    text += ", moisture by a raster";
  text += "; " + heading_text(request.rules);
  for (const auto& [name, spread] : request.rules.values) {
    if (spread.source == vehicle_source(request.model.vehicle)) continue;  // the vehicle's own numbers
    const campaign::Variable& variable = campaign::contract().variables[campaign::contract().variable_index(name)];
    text += "; " + name + " " + number_text(spread.low) +
            (spread.low == spread.high ? "" : " to " + number_text(spread.high)) + " " + variable.unit;
  }
  if (std::isfinite(request.rules.max_speed))
    text += "; at most " + number_text(kKmPerHour * request.rules.max_speed) + " km/h";
  return text;
}

Json rules_json(const MapRules& rules) {
  Json json = Json::Object{{"go", rules.go},
                           {"no_go", rules.no_go},
                           {"tolerated_outside_share", rules.tolerated_outside_share},
                           {"heading", heading_text(rules)},
                           {"correlation_length_m", rules.correlation_length},
                           {"draws", rules.draws},
                           {"moisture", rules.moisture},
                           {"fidelity", rules.fidelity}};
  if (std::isfinite(rules.max_speed)) json["max_speed_km_h"] = kKmPerHour * rules.max_speed;
  json["values"] = spreads_json(rules.values);
  return json;
}

std::vector<std::pair<std::string, std::string>> raster_hashes(const Region& region) {
  std::vector<std::pair<std::string, std::string>> hashes;
  const auto add = [&](const char* role, const RegionRaster& raster) {
    std::string all;
    for (const fs::path& file : terrain::files_behind(raster.files)) all += file_hash(file);
    hashes.emplace_back(role, all.size() > 32 ? content_hash(all) : all);
  };
  add("elevation", region.elevation);
  if (region.soil_class) add("soil_class", *region.soil_class);
  if (region.land_cover) add("land_cover", *region.land_cover);
  if (region.moisture) add("moisture", *region.moisture);
  if (region.cone_index) add("cone_index", *region.cone_index);
  for (const Obstacle& o : region.obstacles) hashes.emplace_back(o.name, file_hash(o.file));
  return hashes;
}

Json map_inputs(const MapRequest& request) {
  Json inputs = Json::Object{{"version", program_version()},
                             {"revision", program_revision()},
                             {"contract_hash", content_hash(campaign::contract_text())},
                             {"model_hash", request.model.hash}};
  if (!request.model.member_hashes.empty()) inputs["member_hashes"] = Json(request.model.member_hashes);
  if (!request.model.dataset_hash.empty()) inputs["dataset_hash"] = request.model.dataset_hash;
  if (!request.model.crossing_hash.empty()) inputs["crossing_model_hash"] = request.model.crossing_hash;
  inputs["vehicle"] = request.model.vehicle;
  if (request.model.gravity != kGravity) inputs[campaign::kGravityKey] = request.model.gravity;
  if (const auto& need = request.model.cone_index) {
    inputs["vehicle_cone_index"] = Json::Object{
        {"vehicle", need->vehicle}, {"vci1_kPa", need->one_pass / 1e3}, {"vci50_kPa", need->fifty_passes / 1e3}};
  }
  inputs["region"] = request.region.name;
  inputs["region_hash"] = file_hash(request.region.file);
  if (!request.region.soil_text.empty()) inputs["soil"] = request.region.soil_text;
  if (const auto index = request.region.cone_index_everywhere) inputs["cone_index_kPa"] = *index / 1e3;
  for (const auto& [role, hash] : raster_hashes(request.region)) inputs[role + "_hash"] = hash;
  if (!request.region.elevation.heights.unit.empty()) inputs["height_unit"] = request.region.elevation.heights.unit;
  if (request.region.elevation.heights.flat_is_ground) inputs["flat"] = "ground";
  inputs["rules"] = rules_json(request.rules);
  inputs["colour_blind_safe"] = request.colour_blind_safe;
  return inputs;
}

Metadata map_metadata(const MapRequest& request, const Json& inputs) {
  Metadata metadata;
  metadata.emplace_back("TIFFTAG_SOFTWARE", std::string("gonogo ") + program_version());
  for (const char* key : {"version", "revision", "region", "region_hash", "model_hash", "dataset_hash",
                          "elevation_hash", "soil_class_hash", "land_cover_hash", "moisture_hash", "cone_index_hash"})
    if (const Json* value = inputs.find(key)) metadata.emplace_back(std::string("GONOGO_") + key, value->string());
  metadata.emplace_back("GONOGO_rules", inputs.at("rules").dump());
  metadata.emplace_back("GONOGO_heading", heading_text(request.rules));
  if (const Json* need = inputs.find("vehicle_cone_index"))
    metadata.emplace_back("GONOGO_vehicle_cone_index", need->dump());
  metadata.emplace_back("GONOGO_vehicle", vehicle_text(request.model));
  if (request.model.gravity != kGravity)
    metadata.emplace_back(std::string("GONOGO_") + campaign::kGravityKey, line("%.6g", request.model.gravity));
  return metadata;
}

namespace {

/// The summary of the map in `request.out`, if it was made from the same inputs and its files are unchanged.
std::optional<MapSummary> find_finished_map(const MapRequest& request, const Json& inputs) {
  const fs::path record_file = request.out / kRecordName;
  if (!fs::exists(record_file)) return std::nullopt;
  MapSummary summary;
  try {
    const Json record = Json::read(record_file);
    require_seal(record, record_file.string(), kMakeAgain);
    if (record.at("inputs").dump() != inputs.dump()) return std::nullopt;
    for (const auto& [name, hash] : record.at("files").members()) {
      if (!fs::exists(request.out / name) || file_hash(request.out / name) != hash.string()) return std::nullopt;
      summary.files.push_back(request.out / name);
    }
    summary.area = AreaCount::from_json(record.at("area"));
    summary.gravity = request.model.gravity;
    summary.area_km2 = record.at("area_km2").number();
    for (const Json& remark : record.at("remarks").items()) summary.remarks.push_back(remark.string());
  } catch (const InputError&) {
    return std::nullopt;  // not a record of this program: make the map again
  }
  summary.files.push_back(record_file);
  summary.reused = true;
  return summary;
}

/// Writes map.json. It is written last, so a folder with this file holds a finished map.
void write_map_record(const MapRequest& request, const Json& inputs, const MapSummary& summary) {
  Json record = Json::Object{{"schema", "gonogo/map/1"},
                             {"inputs", inputs},
                             {"area_km2", summary.area_km2},
                             {"area", summary.area.to_json()},
                             {"remarks", Json(summary.remarks)}};
  Json files = Json::object();
  for (const fs::path& file : summary.files) files[file.filename().string()] = file_hash(file);
  record["files"] = files;
  write_file_atomically(request.out / kRecordName, sealed(std::move(record)).dump(2) + "\n");
}

}  // namespace

using terrain::MapGrid;
namespace {

std::string percent(double share) { return line("%.1f %%", 100 * share); }

/// What a friction angle of this meaning counts as; empty if it is one of triaxial compression by its source.
std::string test_remark(const Region& region, const Spread& angle) {
  const terrain::AngleMeaning& meaning = angle.meaning;
  const double middle = (angle.low + angle.high) / 2;
  if (meaning.assumed)
    return "the friction angle does not say its test and counts as triaxial compression, peak: " +
           line("of %.3g deg, ", middle) + terrain::readings_of(middle);
  if (meaning.is_triaxial_peak()) return "";
  const terrain::MacroscopicSoil measured{middle, 0, 0, 0.5, meaning};
  const terrain::MacroscopicSoil triaxial = region.table ? as_triaxial(*region.table, measured) : as_triaxial(measured);
  return line("a friction angle of %.3g deg by %s counts as %.3g deg of triaxial compression", middle,
              meaning.text().c_str(), triaxial.friction_angle);
}

/// What the friction angles of a soil mean, where that is not as the model takes them.
void remark_on_tests(const Region& region, const Soil& soil, const std::string& where,
                     std::vector<std::string>& remarks) {
  std::vector<SoilSample> samples = soil.samples;
  if (samples.empty()) samples.emplace_back();
  std::set<std::string> said;
  for (const SoilSample& sample : samples)
    for (const Spreads* spreads : {&sample.values, &soil.values, &region.values}) {
      const auto angle = spreads->find("friction_angle");
      if (angle == spreads->end()) continue;
      if (angle->second.kind != Spread::Kind::unknown) said.insert(test_remark(region, angle->second));
      break;
    }
  said.erase("");
  if (said.empty()) return;
  const std::size_t others = said.size() - 1;
  remarks.push_back(where + *said.begin() + (others > 0 ? line("; likewise %zu more of its angles", others) : ""));
}

/// Remarks on a soil of the map: what is too soft, has no texture, or was not sampled.
void remark_on_soil(const Region& region, const Soil& soil, const SoilPoints& points, double share,
                    std::vector<std::string>& remarks) {
  const std::string where = soil.name + " (" + percent(share) + " of the area): ";
  if (!soil.not_texture.empty())
    remarks.push_back(where + "the soil measured in " + soil.not_texture +
                      ", not the USDA texture of that name, which is written with a blank");
  for (const std::string& because : points.soft_because()) remarks.push_back(where + because);
  if (has_cone_index(region) && !is_fine_grained(region, soil).value_or(true))
    remarks.push_back(where + "coarse-grained, so that its strength decides and the measured cone index is not used");
  if (!is_fine_grained(region, soil))
    remarks.push_back(where +
                      "no texture is given; the vehicle's cone index is required only where the friction angle is " +
                      line("below %g degrees", kMinAngleOfSand));
  for (const std::string& because : points.stronger_because()) remarks.push_back(where + because);
  if (!points.outside_because().empty()) remarks.push_back(where + join_words(points.outside_because()));
  remark_on_tests(region, soil, where, remarks);
  for (const std::string& doubt : soil.doubts) remarks.push_back(where + doubt);
}

/// Which variables leave what trials sampled, and on which share of the area.
void remark_on_ranges(const OutcomeModel& model, const MapDigest& digest, const SoilTable& table,
                      std::vector<std::string>& remarks) {
  const double total = double(digest.area.total());
  const auto& variables = campaign::contract().variables;
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const bool along = variables[v].name == "slope_along";
    double cells = along ? double(digest.steeper) : 0;
    for (std::size_t s = 0; s < table.soils.size() && !along; ++s)
      if (!table.has_ditch[s]) cells += double(table.cells[s]) * table.responses[s].points().outside_share(v);
    if (cells > 0)
      remarks.push_back(
          variables[v].name +
          line(" lies outside what trials sampled, %g to %g ", model.sampled[v].minimum, model.sampled[v].maximum) +
          variables[v].unit + ", on " + percent(cells / total) + " of the area" +
          (along ? " (uphill)" : " (soils by their shares)"));
  }
}

/// Where trials of ditches answer, and where a ditch between the bounds of geometry stays unknown, and why.
void remark_on_ditches(const MapRequest& request, const MapSources& sources, const MapDigest& digest,
                       const SoilTable& table, std::vector<std::string>& remarks) {
  if (request.model.crossing_sampled.empty() || !request.region.crossing) return;
  double modelled = 0, other_size = 0;
  for (std::size_t s = 0; s < table.soils.size(); ++s)
    if (table.has_ditch[s]) modelled += double(table.cells[s]);
  for (std::size_t k = 0; k < request.region.obstacles.size(); ++k) {
    const auto found = digest.rules.find(std::uint32_t(obstacle_rule(request.region, k, Crossing::unknown)));
    if (request.region.obstacles[k].kind == ObstacleKind::ditch && found != digest.rules.end())
      other_size += double(found->second);
  }
  const double total = double(digest.area.total()), unanswered = double(digest.unanswered_ditches);
  const Range width = request.region.crossing->ditch_width, depth = request.region.crossing->ditch_depth;
  if (modelled > 0) {
    remarks.push_back("trials of ditches decide on " + percent((modelled - unanswered) / total) +
                      " of the area, where a ditch lies between the bounds of geometry; its P(go) is the least of "
                      "the soil's and the ditch's");
    if (sources.ditch_step > 0.05)
      remarks.push_back(line("widths and depths of ditches are rounded up to %g m", sources.ditch_step));
  }
  if (unanswered > 0)
    remarks.push_back("ditches on " + percent(unanswered / total) +
                      " of the area are unknown: their trials sampled no such soil or slope");
  if (other_size > 0)
    remarks.push_back("ditches on " + percent(other_size / total) + " of the area are unknown: their trials sampled " +
                      line("widths of %g to %g m and depths of %g to %g m", width.minimum, width.maximum, depth.minimum,
                           depth.maximum));
}

/// What the map does where nobody said what the soil is.
void remark_on_no_soil(const MapSummary& summary, const SoilTable& table, std::vector<std::string>& remarks) {
  const bool any = std::any_of(table.soils.begin(), table.soils.end(), [](const Soil& s) { return !s.given; });
  if (any)
    remarks.push_back("no soil was given: it may be any USDA texture, so that " +
                      percent(summary.area.share(campaign::Verdict::unknown)) +
                      " of the area is unknown; name a soil with --soil, and a moisture with --moisture");
}

/// Whether every soil on the map says this variable itself.
bool soils_say(const SoilTable& table, const std::string& variable) {
  const auto says = [&](const Spreads& values) {
    const auto found = values.find(variable);
    return found != values.end() && found->second.kind != Spread::Kind::unknown;
  };
  for (std::size_t s = 0; s < table.soils.size(); ++s) {
    const Soil& soil = table.soils[s];
    if (table.cells[s] == 0 || says(soil.values)) continue;
    const auto& samples = soil.samples;
    if (samples.empty() ||
        !std::all_of(samples.begin(), samples.end(), [&](const SoilSample& x) { return says(x.values); }))
      return false;
  }
  return !table.soils.empty();
}

/// What P(go) is averaged over, besides the soil.
void remark_on_mission(const Region& region, const MapRules& rules, const SoilTable& table,
                       std::vector<std::string>& remarks) {
  Spreads spreads = rules.values;
  spreads.insert(region.values.begin(), region.values.end());
  std::vector<std::string> averaged;
  for (const auto& [name, spread] : spreads) {
    const campaign::Variable& variable = campaign::contract().variables[campaign::contract().variable_index(name)];
    if (spread.kind != Spread::Kind::range || variable.prior == "region" || soils_say(table, name)) continue;
    averaged.push_back(name + line(" %.3g to %.3g", spread.low, spread.high) +
                       (variable.unit == "1" || variable.unit == "-" ? "" : " " + variable.unit) + " (" +
                       spread.source + ")");
  }
  if (!averaged.empty()) remarks.push_back("P(go) is averaged over " + join_words(averaged) + "; fix one with --set");
}

std::vector<std::string> remarks_on(const MapSummary& summary, const MapRequest& request, const MapDigest& digest,
                                    const SoilTable& table) {
  const Region& region = request.region;
  std::vector<std::string> remarks = request.model.remarks;
  if (request.model.gravity != kGravity)
    remarks.push_back("trials and ground have a gravity of " + gravity_text(request.model.gravity));
  remark_on_no_soil(summary, table, remarks);
  for (std::size_t s = 0; s < table.soils.size(); ++s)
    if (table.cells[s] > 0 && !table.has_ditch[s])
      remark_on_soil(region, table.soils[s], table.responses[s].points(),
                     double(table.cells[s]) / double(summary.area.total()), remarks);
  if (summary.area.total() > 0) remark_on_ranges(request.model, digest, table, remarks);
  remark_on_mission(region, request.rules, table, remarks);
  if (summary.area.total() == 0)
    remarks.push_back("no cell has a slope: every cell is at the border or next to one without elevation");
  const bool given = std::all_of(table.soils.begin(), table.soils.end(), [](const Soil& s) { return s.given; });
  if (const double share = summary.area.share(campaign::Verdict::unknown, campaign::Reason::input_missing);
      given && share > 0)
    remarks.push_back("the soil is unknown on " + percent(share) +
                      " of the area: nodata, or a code the region's table does not list");
  if (const double share = summary.area.share(campaign::Verdict::unknown, campaign::Reason::land_unknown); share > 0)
    remarks.push_back("the land cover is unknown on " + percent(share) +
                      " of the area: nodata, or a code the region's table does not list");
  for (const std::string& soil : table.without_samples)
    remarks.push_back(soil + " is unknown: no sample has that water content");
  return remarks;
}

void remark_on_files(const MapSources& sources, std::vector<std::string>& remarks) {
  constexpr double coarse = 100;  // [m]
  const terrain::RasterSource& elevation = sources.elevation;
  for (const std::string& remark : sources.remarks()) remarks.push_back(remark);
  if (!elevation.how_warped().empty()) remarks.push_back(elevation.how_warped());
  const double cell = std::max(elevation.grid().cell_width_m(), elevation.grid().cell_height_m());
  if (cell > coarse)
    remarks.push_back(
        line("cells are %.4g m wide: slopes are means over such lengths, and ground that a vehicle meets is "
             "steeper in places; cells of at most %g m show more",
             cell, coarse));
}

/// What the map cannot say about its place on the globe.
void remark_on_place(const terrain::GlobeAnswer& globe, std::vector<std::string>& remarks) {
  if (!globe.place)
    remarks.push_back(no_overlay(globe.why_not));
  else if (const std::string remark = terrain::remark_on(*globe.place); !remark.empty())
    remarks.push_back(remark);
}

/// Writes the files that need every tile.
void finish_map(const MapRequest& request, const MapGrid& grid, const SoilTable& table, const Metadata& metadata,
                const std::vector<MapLayer>& layers, const MapDigest& digest, MapSummary& summary) {
  const terrain::GlobeAnswer globe = terrain::place_on_globe(grid);
  remark_on_place(globe, summary.remarks);
  stop_if_cancelled();
  write_file_atomically(request.out / "area.csv", summary.area.csv(grid.cell_area_m2()));
  write_map_figure(request, grid, table, summary, digest.picture, request.out / "map.png");
  write_map_page(request, grid, table, summary, digest.page, metadata, request.out / "index.html");
  stop_if_cancelled();
  for (const char* name : {"area.csv", "map.png", "index.html"}) summary.files.push_back(request.out / name);
  write_map_exports(request, {grid, layers, digest.speeds, globe.place}, summary);
}

/// Removes the map that stands in `folder`: its page and record first, so that what is left never looks like a map.
void remove_map(const fs::path& folder) {
  std::vector<fs::path> files = {folder / kPageName, folder / kRecordName};
  try {
    const Json record =
        fs::exists(files.back()) ? Json::read(files.back()) : Json(Json::Object{{"files", Json::object()}});
    for (const auto& [name, hash] : record.at("files").members()) {
      if (fs::path(name).filename() != name) continue;
      files.push_back(folder / name);
      files.push_back(folder / (name + ".aux.xml"));
      files.push_back((folder / name).replace_extension(".qml"));
    }
  } catch (const InputError&) {  // not a record of this program: the files that it names stay
  }
  std::error_code ignored;
  for (const fs::path& file : files) fs::remove(file, ignored);
}

/// Place in the order in which files of a map come: a page, and then a record, have all others beside them.
int turn_of(const fs::path& file) { return file.filename() == kRecordName ? 2 : file.filename() == kPageName ? 1 : 0; }

/// Puts the finished map that grew in `grown` in the place of the one in `folder`, its page and its record last. An
/// interruption leaves `folder` without them, and the next run goes on from here.
void put_in_place(const fs::path& grown, const fs::path& folder) {
  remove_map(folder);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(grown))
    if (entry.is_regular_file() && entry.path().filename().string().front() != '.') files.push_back(entry.path());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) { return turn_of(a) < turn_of(b); });
  for (const fs::path& file : files) fs::rename(file, folder / file.filename());
  fs::remove_all(grown);
}

/// One run at a time in a map's folder.
FileLock lock_map(const fs::path& folder) {
  create_folder(folder);
  for (;;) {
    FileLock lock = lock_folder(folder / kUnfinished);
    if (fs::exists(folder / kUnfinished / ".lock")) return lock;  // another run may have removed what was locked
  }
}

/// Removes the scratch files after InputError. After other errors the next run continues from them.
void evaluate_or_forget(MapTiles& tiles, const MapSources& sources, const SoilTable& table, const MapDigest& shape) {
  try {
    tiles.evaluate(sources, table, shape);
  } catch (const InputError&) {
    tiles.forget();
    throw;
  }
}

}  // namespace

namespace {

/// Makes the map in request.out, where nothing else writes.
MapSummary grow_map(const MapRequest& request, const MapSources& sources, const Json& origin, SoilTable& table) {
  const MapGrid& grid = sources.elevation.grid();
  const Metadata metadata = map_metadata(request, origin);
  MapTiles tiles(request, grid, map_layers(request.rules, request.model, request.colour_blind_safe, metadata),
                 origin.dump());
  MapDigest digest{{}, Picture(grid, kPictureCells), PageCells(grid)};
  evaluate_or_forget(tiles, sources, table, digest);
  tiles.collect(table, digest);
  MapSummary summary{.area = digest.area, .gravity = request.model.gravity};
  summary.area_km2 = double(summary.area.total()) * grid.cell_area_m2() * 1e-6;
  summary.remarks = remarks_on(summary, request, digest, table);
  if (summary.area.total() > 0) remark_on_ditches(request, sources, digest, table, summary.remarks);
  remark_on_files(sources, summary.remarks);
  summary.tiles_found = tiles.found();
  summary.files = tiles.finish();
  finish_map(request, grid, table, metadata, tiles.layers(), digest, summary);
  write_map_record(request, origin, summary);
  summary.files.push_back(request.out / kRecordName);
  tiles.forget();
  return summary;
}

}  // namespace

MapSummary make_map(const MapRequest& request) {
  const MapSources sources = open_sources(request.region);
  const Json origin = map_inputs(request);
  if (auto finished = find_finished_map(request, origin)) return *finished;
  const MapGrid& grid = sources.elevation.grid();
  require_gravity(request.region, grid.body_radius, request.model.gravity);
  const FileLock lock = lock_map(request.out);
  MapRequest grown = request;
  grown.out = request.out / kUnfinished;
  MapSummary summary;
  if (auto finished = find_finished_map(grown, origin)) {
    summary = std::move(*finished);
  } else {
    try {
      SoilTable table = make_soil_table(request.model, request.region, request.rules,
                                        gradient_error(request.region.elevation, grid), sources);
      summary = grow_map(grown, sources, origin, table);
    } catch (const InputError&) {
      fs::remove_all(grown.out);
      throw;
    }
  }
  stop_if_cancelled();
  put_in_place(grown.out, request.out);
  for (fs::path& file : summary.files) file = request.out / file.filename();
  return summary;
}

void require_whole_map(const fs::path& folder, const std::vector<std::string>& files) {
  const Json record = Json::read(folder / kRecordName);
  require_seal(record, (folder / kRecordName).string(), kMakeAgain);
  for (const std::string& name : files) {
    const Json* hash = record.at("files").find(name);
    if (!hash || !fs::exists(folder / name) || file_hash(folder / name) != hash->string())
      throw InputError((folder / name).string() + ": is not the file that " + (folder / kRecordName).string() +
                       " was written with; " + kMakeAgain);
  }
}

}  // namespace gonogo::map
