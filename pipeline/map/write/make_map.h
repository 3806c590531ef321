// The map of a region: slope from the elevation raster, soil from the soil raster and the region's table, P(go) from
// the model, class and reason by the rules; written as GeoTIFF layers, a figure, a page and an area table. Works block
// by block in threads: memory does not grow with the raster, a killed run goes on where it was, and neither threads nor
// block size change a bit of the result.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

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
  int threads = 0;       // 0: all cores
  int block_rows = 512;  // rows of a tile evaluated at a time
};

struct MapSummary {
  AreaCount area;
  double area_km2 = 0;
  std::vector<std::filesystem::path>
      files;                         // go.tif, p_go.tif, reason.tif, outside_share.tif, map.png, area.csv, map.json
  std::vector<std::string> remarks;  // one sentence each, about what the map cannot say and why
  std::size_t blocks_found = 0;      // that an interrupted run had finished
  bool reused = false;               // the folder already held this very map
};

/// Writes the map unless the folder already holds the one of the same model, region, rasters, rules and program
/// version, with untouched files. Throws InputError for unusable rasters, DeviceError when writing fails; earlier files
/// are then as they were.
MapSummary make_map(const MapRequest& request);

}  // namespace gonogo::map
