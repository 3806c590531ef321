// Writes what can be reached to files.
#pragma once
#include <filesystem>
#include <vector>

#include "base/json/json.h"
#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/route/cost.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {

/// GeoTIFF of the min cost `least` [cell, unit_of(cost)], row by row from the north. No way: nodata.
void write_reach(const std::filesystem::path& path, const terrain::MapGrid& grid, RouteCost cost,
                 const std::vector<float>& least, const Metadata& metadata, int threads);

/// GeoPackage with the layer "isochrones": one polygon for each connected piece of each band. `interval` is the width
/// of a band [unit_of(cost)]; 0: a round one. Throws InputError for extensions other than .gpkg, and as cost_bands().
void write_isochrones(const std::filesystem::path& path, const terrain::MapGrid& grid, RouteCost cost,
                      const std::vector<float>& least, double interval);

/// GeoPackage with the layer "regions": the kMaxRegions largest connected regions by rank, and all smaller ones as one
/// more. Returns { count, largest_km2, passable_km2 }.
Json write_regions(const std::filesystem::path& path, const terrain::MapGrid& grid,
                   const std::vector<std::int32_t>& region);

}  // namespace gonogo::map
