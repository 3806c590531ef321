#include "pipeline/map/route/reach_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/map/route/bands.h"
#include "terrain/raster/geotiff.h"
#include "terrain/raster/polygons.h"
#include "terrain/raster/tile_codec.h"

namespace gonogo::map {
namespace {

namespace fs = std::filesystem;

// Single hue over distance, light to dark; pairs of neighbours that differ for regions. No red: that is no-go.
constexpr std::array<int, 3> kNear = {222, 235, 247}, kFar = {63, 0, 125};
constexpr std::array<const char*, 8> kRegionColours = {"#1f78b4", "#b2df8a", "#6a3d9a", "#fdbf6f",
                                                       "#33a02c", "#a6cee3", "#b15928", "#cab2d6"};

void require_geopackage(const fs::path& path, const char* option) {
  if (path.extension() != ".gpkg")
    throw InputError(std::string("route: ") + option + ": \"" + path.string() +
                     "\" is no name of a GeoPackage; polygons are written as .gpkg");
}

std::string between(double share) {
  const auto mix = [&](std::size_t i) { return int(std::lround(kNear[i] + share * (kFar[i] - kNear[i]))); };
  return line("#%02x%02x%02x", mix(0), mix(1), mix(2));
}

}  // namespace

void write_reach(const fs::path& path, const terrain::MapGrid& grid, RouteCost cost, const std::vector<float>& least,
                 const Metadata& metadata, int threads) {
  float most = 1;
  for (const float c : least)
    if (std::isfinite(c)) most = std::max(most, c);
  terrain::GeoTiffWriter writer(
      path, grid,
      {.name = "least cost from the start, " + name_of(cost),
       .unit = unit_of(cost),
       .classes = false,
       .legend = {{0, "0", between(0)}, {double(most), line("%g %s", most, unit_of(cost)), between(1)}},
       .metadata = metadata});
  for (int top = 0; top < grid.rows; top += terrain::kTileCells) {
    const int rows = std::min(terrain::kTileCells, grid.rows - top);
    terrain::Tile band(grid.columns, rows, 0);
    for (std::size_t i = 0; i < band.value.size(); ++i) {
      const float value = least[std::size_t(top) * std::size_t(grid.columns) + i];
      band.value[i] = std::isfinite(value) ? value : std::numeric_limits<float>::quiet_NaN();
    }
    writer.write({0, top, grid.columns, rows}, band);
  }
  writer.finish(threads);
}

void write_isochrones(const fs::path& path, const terrain::MapGrid& grid, RouteCost cost,
                      const std::vector<float>& least, double interval) {
  require_geopackage(path, "--isochrones");
  const CostBands bands = cost_bands(cost, least, interval);
  std::vector<terrain::LegendEntry> legend;
  for (std::size_t b = 0; b < bands.label.size(); ++b)
    legend.push_back({double(b), bands.label[b], between(double(b + 1) / double(bands.label.size()))});
  terrain::write_cell_polygons(path, "isochrones", grid, bands.band, legend);
}

Json write_regions(const fs::path& path, const terrain::MapGrid& grid, const std::vector<std::int32_t>& region) {
  require_geopackage(path, "--regions");
  const LargestRegions regions = largest_regions(region);
  const double cell_km2 = grid.cell_area_m2() * 1e-6;
  std::vector<terrain::LegendEntry> legend;
  for (std::size_t k = 0; k < std::min(regions.cells.size(), kMaxRegions); ++k)
    legend.push_back({double(k), line("region %zu: %.4g km2", k + 1, double(regions.cells[k]) * cell_km2),
                      kRegionColours[k % kRegionColours.size()]});
  if (regions.cells.size() > kMaxRegions) legend.push_back({double(kMaxRegions), "smaller regions", "#bdbdbd"});
  terrain::write_cell_polygons(path, "regions", grid, regions.rank, legend);
  Json json = Json::object();
  json["count"] = std::uint64_t(regions.cells.size());
  json["largest_km2"] = regions.cells.empty() ? 0.0 : double(regions.cells.front()) * cell_km2;
  json["passable_km2"] =
      double(std::accumulate(regions.cells.begin(), regions.cells.end(), std::uint64_t(0))) * cell_km2;
  return json;
}

}  // namespace gonogo::map
