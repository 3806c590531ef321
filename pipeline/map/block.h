// One block of a map: slope and aspect from elevation, soil from its raster, every layer from the soil's tables.
#pragma once
#include <optional>

#include "pipeline/map/layers.h"
#include "pipeline/map/picture.h"
#include "pipeline/map/soil_table.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::pipeline {

struct MapSources {
  terrain::RasterSource elevation;
  std::optional<terrain::RasterSource> soil_class;
};

MapSources open_sources(const Region& region);

/// Standard error of the rise per metre of Horn's gradient, from the elevation's error e and the correlation r between
/// neighbouring cells: e sqrt(1 - r) sqrt(12) / (8 cell), the weights 1 2 1 of both sides squared and added.
double gradient_error(const RegionRaster& elevation, const terrain::MapGrid& grid);

SoilTable make_soil_table(const OutcomeModel& model, const Region& region, const MapRules& rules,
                          double gradient_error);

/// Cells depend on nothing but their own inputs, so threads and blocks cannot change a bit.
BlockLayers evaluate_block(const MapSources& sources, const SoilTable& table, const std::vector<MapLayer>& layers,
                           const MapRules& rules, terrain::Window window, int threads);

}  // namespace gonogo::pipeline
