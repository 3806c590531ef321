// What can be reached: bands of equal cost (isochrones) and the largest connected regions, and their files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/route/plan_route.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {

inline constexpr std::uint8_t kNoBand = 255;
inline constexpr int kMaxBands = 250;

/// Bands of equal cost. Band b holds the cells with b interval <= cost < (b + 1) interval.
struct CostBands {
  double interval = 0;             // width of a band [unit_of(cost)]
  std::vector<std::string> label;  // [band] "10 to 20 min"
  std::vector<std::uint8_t> band;  // [cell]; kNoBand: cannot be reached
};

/// `least`: cost of the cheapest way to each cell; infinity where there is none. An interval of 0 becomes the smallest
/// round one that gives at most eight bands. Throws InputError for an interval that is negative or not finite, or that
/// gives more than kMaxBands bands.
CostBands cost_bands(RouteCost cost, const std::vector<float>& least, double interval);

/// Regions that are ranked one by one.
inline constexpr std::size_t kMaxRegions = 20;

struct LargestRegions {
  std::vector<std::uint8_t> rank;    // [cell] 0: largest region; kMaxRegions: all smaller ones; kNoBand: none
  std::vector<std::uint64_t> cells;  // [region] largest first
};

/// Ranks the result of connected_regions(). Of equally large regions the one with the lower first cell comes first.
LargestRegions largest_regions(const std::vector<std::int32_t>& region);

/// GeoTIFF of the min cost `least` [cell, unit_of(cost)], row by row from the north. No way: nodata.
void write_reach(const std::filesystem::path& path, const terrain::MapGrid& grid, RouteCost cost,
                 const std::vector<float>& least, const Metadata& metadata, int threads);

/// GeoPackage with the layer "isochrones": one polygon for each connected piece of each band. `interval` is the width
/// of a band [unit_of(cost)]; 0: a round one. Throws InputError for extensions other than .gpkg, and as cost_bands().
void write_isochrones(const std::filesystem::path& path, const terrain::MapGrid& grid, RouteCost cost,
                      const std::vector<float>& least, double interval);

/// GeoPackage with the layer "regions": the kMaxRegions largest connected regions by rank, and all smaller ones as one
/// more.
ConnectedRegions write_regions(const std::filesystem::path& path, const terrain::MapGrid& grid,
                               const std::vector<std::int32_t>& region);

}  // namespace gonogo::map
