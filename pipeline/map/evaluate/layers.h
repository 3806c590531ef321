// The layers of a map, their legends derived from the contract, and the value of each in a cell.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/region/rules.h"
#include "terrain/raster/geotiff.h"

namespace gonogo::map {

using Metadata = std::vector<std::pair<std::string, std::string>>;

/// Everything a map says about one cell.
struct CellState {
  CellClass result;                    // in the heading of the map
  float p_go = 0;                      // likewise
  const CellAnswer* answer = nullptr;  // null where the soil is not known or a rule of the land decides
};

struct MapLayer {
  std::string file;  // without extension
  terrain::LayerInfo info;
  std::function<float(const CellState&)> value;  // not-a-number: nodata
};

/// In the order of the files; class, P(go), reason and outside_share come first.
std::vector<MapLayer> map_layers(const MapRules& rules, bool has_measures, bool has_novelty, bool colour_blind_safe,
                                 const Metadata& metadata);

std::vector<terrain::LegendEntry> class_legend(bool colour_blind_safe);
std::vector<terrain::LegendEntry> reason_legend();
std::vector<terrain::LegendEntry> p_go_legend();

}  // namespace gonogo::map
