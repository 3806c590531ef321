// The layers of a map: file, legend, and value in a cell. Legends follow the contract's classes and reasons.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/region/rules.h"
#include "terrain/raster/layer/geotiff.h"

namespace gonogo::map {

using Metadata = std::vector<std::pair<std::string, std::string>>;

/// What a map says about one cell. MapLayer::value reads it.
struct CellState {
  CellClass result;                    // class and reason in the heading of the map
  float p_go = 0;                      // P(go) in the heading of the map; NaN: not known
  const CellAnswer* answer = nullptr;  // null where the soil is unknown or a land rule decides
};

struct MapLayer {
  std::string file;  // without extension
  terrain::LayerInfo info;
  std::function<float(const CellState&)> value;  // NaN: nodata
};

/// All layers of a map, in the order of their files.
std::vector<MapLayer> map_layers(const MapRules& rules, const OutcomeModel& model, bool colour_blind_safe,
                                 const Metadata& metadata);

/// Position of the layer with this file; nothing where the map has none.
std::optional<std::size_t> find_layer(const std::vector<MapLayer>& layers, const std::string& file);

std::vector<terrain::LegendEntry> class_legend(bool colour_blind_safe);
std::vector<terrain::LegendEntry> reason_legend();
std::vector<terrain::LegendEntry> p_go_legend();

}  // namespace gonogo::map
