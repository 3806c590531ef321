#include "pipeline/map/write/map_record.h"

#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/line.h"
#include "base/units.h"
#include "base/version.h"
#include "pipeline/campaign/study/study.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::map {
namespace fs = std::filesystem;
namespace {

constexpr const char* kRecordName = "map.json";

Json spreads_json(const Spreads& spreads) {
  Json json = Json::object();
  for (const auto& [name, spread] : spreads) {
    Json entry = Json::object();
    if (spread.kind == Spread::Kind::unknown)
      entry["unknown"] = spread.source;
    else
      entry["range"] = Json::Array{spread.low, spread.high};
    json[name] = entry;
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

Json rules_json(const MapRules& rules) {
  Json json = Json::object();
  json["go"] = rules.go;
  json["no_go"] = rules.no_go;
  json["tolerated_outside_share"] = rules.tolerated_outside_share;
  json["heading"] = heading_text(rules);
  json["correlation_length_m"] = rules.correlation_length;
  json["draws"] = rules.draws;
  json["moisture"] = rules.moisture;
  json["fidelity"] = rules.fidelity;
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
  Json inputs = Json::object();
  inputs["version"] = program_version();
  inputs["revision"] = program_revision();
  inputs["contract_hash"] = content_hash(campaign::contract_text());
  inputs["model_hash"] = request.model.hash;
  if (!request.model.member_hashes.empty()) inputs["member_hashes"] = Json(request.model.member_hashes);
  if (!request.model.dataset_hash.empty()) inputs["dataset_hash"] = request.model.dataset_hash;
  if (!request.model.crossing_hash.empty()) inputs["crossing_model_hash"] = request.model.crossing_hash;
  inputs["vehicle"] = request.model.vehicle;
  if (request.model.gravity != kGravity) inputs[campaign::kGravityKey] = request.model.gravity;
  if (const auto& need = request.model.cone_index) {
    Json index = Json::object();
    index["vehicle"] = need->vehicle;
    index["vci1_kPa"] = need->one_pass / 1e3;
    index["vci50_kPa"] = need->fifty_passes / 1e3;
    inputs["vehicle_cone_index"] = index;
  }
  inputs["region"] = request.region.name;
  inputs["region_hash"] = file_hash(request.region.file);
  if (!request.region.soil_text.empty()) inputs["soil"] = request.region.soil_text;
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

std::optional<MapSummary> find_finished_map(const MapRequest& request, const Json& inputs) {
  const fs::path record_file = request.out / kRecordName;
  if (!fs::exists(record_file)) return std::nullopt;
  MapSummary summary;
  try {
    const Json record = Json::read(record_file);
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

void write_map_record(const MapRequest& request, const Json& inputs, const MapSummary& summary) {
  Json record = Json::object();
  record["schema"] = "gonogo/map/1";
  record["inputs"] = inputs;
  record["area_km2"] = summary.area_km2;
  record["area"] = summary.area.to_json();
  record["remarks"] = Json(summary.remarks);
  Json files = Json::object();
  for (const fs::path& file : summary.files) files[file.filename().string()] = file_hash(file);
  record["files"] = files;
  write_file_atomically(request.out / kRecordName, record.dump(2) + "\n");
}

}  // namespace gonogo::map
