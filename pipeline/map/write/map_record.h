// map.json: the inputs and the results of a map. A later run reads it to see that the map already exists.
#pragma once
#include <filesystem>
#include <optional>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

/// "the vehicle hmmwv"; of trials of one wheel "the quarter vehicle hmmwv_quarter".
std::string vehicle_text(const OutcomeModel& model);
/// Title of page and figure: the vehicle's name, or the region's where the vehicle is not known.
std::string map_title(const MapRequest& request);

/// Pairs (role, hash) for every raster of a region. A raster of several files, or a VRT, is hashed over all of them.
std::vector<std::pair<std::string, std::string>> raster_hashes(const Region& region);

/// The rules of section "map", as map.json and the page hold them.
Json rules_json(const MapRules& rules);

/// Everything the result depends on: program version, hashes of model, region and rasters, rules, palette.
Json map_inputs(const MapRequest& request);

/// A short form of map_inputs() for the metadata of the layers.
Metadata map_metadata(const MapRequest& request, const Json& inputs);

/// The summary of the map in `request.out`, if it was made from the same inputs and its files are unchanged.
std::optional<MapSummary> find_finished_map(const MapRequest& request, const Json& inputs);

/// Writes map.json. It is written last, so a folder with this file holds a finished map.
void write_map_record(const MapRequest& request, const Json& inputs, const MapSummary& summary);

}  // namespace gonogo::map
