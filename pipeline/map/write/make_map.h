// Makes the map of a region: slope from the elevation raster, soil from the soil raster, P(go) from the model, class
// and reason from the rules. The outputs are GeoTIFF layers, a figure, a page and an area table.
//
// Threads work tile by tile, so memory does not grow with the raster. A run that was killed continues with the first
// unfinished tile. The number of threads changes no bit of the result.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/region/area.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/region/rules.h"

namespace gonogo::map {

struct MapRequest {
  OutcomeModel model;
  Region region;
  MapRules rules;
  std::filesystem::path out;  // folder
  bool colour_blind_safe = false;
  int threads = 0;  // 0: all cores
};

struct MapSummary {
  AreaCount area;
  double area_km2 = 0;                         // of the cells that have a slope
  std::vector<std::filesystem::path> files{};  // all that were written; map.json is the last
  std::vector<std::string> remarks{};          // one sentence each: what the map cannot say, and why
  std::size_t tiles_found = 0;                 // tiles that an interrupted run had finished
  double gravity = kGravity;                   // of trials and ground [m/s^2]
  bool reused = false;                         // the folder already held this map; nothing was written
};

/// Writes the map. Does nothing if the folder holds the map of the same model, region, rasters, rules and program
/// version, with all files unchanged. The map grows in the folder's own folder .new and then takes the place of an
/// earlier one; files of that map, but no others, are removed. Throws InputError for unusable rasters and where another
/// run makes a map in this folder, and DeviceError if writing fails. In these cases earlier files stay as they were.
MapSummary make_map(const MapRequest& request);

/// Throws InputError unless these files of a map are those that its record was written with.
void require_whole_map(const std::filesystem::path& folder, const std::vector<std::string>& files);

/// "the vehicle hmmwv"; of trials of one wheel "the quarter vehicle hmmwv_quarter".
std::string vehicle_text(const OutcomeModel& model);
/// Title of page and figure: the vehicle's name, or the region's where the vehicle is not known.
std::string map_title(const MapRequest& request);

/// What holds on all of the map: "sand, dry; uphill heading; payload 500 kg".
std::string conditions_text(const MapRequest& request);

/// Pairs (role, hash) for every raster of a region. A raster of several files, or a VRT, is hashed over all of them.
std::vector<std::pair<std::string, std::string>> raster_hashes(const Region& region);

/// The rules of section "map", as map.json and the page hold them.
Json rules_json(const MapRules& rules);

/// Everything the result depends on: program version, hashes of model, region and rasters, rules, palette.
Json map_inputs(const MapRequest& request);

/// A short form of map_inputs() for the metadata of the layers.
Metadata map_metadata(const MapRequest& request, const Json& inputs);

}  // namespace gonogo::map
