// What can be reached, as files.
#pragma once
#include <filesystem>
#include <vector>

#include "base/json/json.h"
#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/route/cost.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {

/// GeoTIFF of the least cost [unit_of(cost)], row by row from the north; nodata where there is no way.
void write_reach(const std::filesystem::path& path, const terrain::MapGrid& grid, RouteCost cost,
                 const std::vector<float>& least, const Metadata& metadata, int threads);

/// GeoPackage, layer "isochrones": a polygon for each part of each band of `interval` [unit_of(cost); 0: a round one].
/// Throws InputError for other extensions than .gpkg and for intervals that cost_bands refuses.
void write_isochrones(const std::filesystem::path& path, const terrain::MapGrid& grid, RouteCost cost,
                      const std::vector<float>& least, double interval);

/// GeoPackage, layer "regions": polygons of the largest connected regions by rank, and of the smaller ones together.
/// Returns { count, largest_km2, passable_km2 }.
Json write_regions(const std::filesystem::path& path, const terrain::MapGrid& grid,
                   const std::vector<std::int32_t>& region);

}  // namespace gonogo::map
