// map.json: what a map was made from and what it found; by it a later run sees that the map already exists.
#pragma once
#include <filesystem>
#include <optional>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

/// Hash of every raster of a region by its role; of a VRT or of tiles over all files that it reads.
std::vector<std::pair<std::string, std::string>> raster_hashes(const Region& region);

/// The rules of section "map", as map.json and the page hold them.
Json rules_json(const MapRules& rules);

/// Everything the result depends on: program version, hashes of model, region and rasters, rules, palette.
Json map_inputs(const MapRequest& request);

/// The same, short, for the metadata of the layers.
Metadata map_metadata(const MapRequest& request, const Json& inputs);

/// The summary of the map in `request.out` if it was made from the same inputs and its files are untouched.
std::optional<MapSummary> find_finished_map(const MapRequest& request, const Json& inputs);

/// Written last: a folder with this file holds a whole map.
void write_map_record(const MapRequest& request, const Json& inputs, const MapSummary& summary);

}  // namespace gonogo::map
