// One block of a map: slope and aspect from elevation, soil, moisture and land cover from their rasters, every layer
// from the soil's tables.
#pragma once
#include <optional>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/evaluate/soil_table.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::map {

struct MapSources {
  terrain::RasterSource elevation;
  std::optional<terrain::RasterSource> soil_class, land_cover, moisture, cone_index;

  /// The same with handles of its own, for another thread.
  MapSources again() const;
};

MapSources open_sources(const Region& region);

/// All tiles of the window's size.
struct BlockLayers {
  terrain::Window window;
  terrain::Tile elevation, slope, aspect, shade;
  terrain::Tile soil;                // position in the soil table, -1 unknown; not-a-number without a slope
  terrain::Tile rule;                // 0: the soil decides; 1 + position in land_rules()
  std::vector<terrain::Tile> layer;  // as map_layers() lists them
  const terrain::Tile& verdict() const { return layer[0]; }
  const terrain::Tile& p_go() const { return layer[1]; }
  const terrain::Tile& reason() const { return layer[2]; }
};

/// Standard error of the rise per metre of Horn's gradient, from the elevation's error e and the correlation r between
/// neighbouring cells: e sqrt(1 - r) sqrt(12) / (8 cell), the weights 1 2 1 of both sides squared and added.
double gradient_error(const RegionRaster& elevation, const terrain::MapGrid& grid);

/// Throws InputError for a moisture that the region does not tell.
SoilTable make_soil_table(const OutcomeModel& model, const Region& region, const MapRules& rules,
                          double gradient_error);

/// Cells depend on nothing but their own inputs, so threads and blocks cannot change a bit. One thread at a time for
/// the same sources.
BlockLayers evaluate_block(const MapSources& sources, const Region& region, const SoilTable& table,
                           const std::vector<MapLayer>& layers, const MapRules& rules, terrain::Window window);

}  // namespace gonogo::map
