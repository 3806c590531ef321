#include "pipeline/map/route/reach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/format.h"
#include "terrain/raster/layer/cog.h"
#include "terrain/raster/layer/geotiff.h"
#include "terrain/raster/vector/write_vector.h"

namespace gonogo::map {

namespace {

constexpr double kWantedBands = 8;
constexpr std::array<const char*, 4> kMeaning = {"metres", "seconds", "-ln of the chance to get through", "joules"};

/// The smallest round number that is at least `least`. Seconds are rounded to minutes and hours, other units to 1, 2 or
/// 5 times a power of ten.
double round_interval(RouteCost cost, double least) {
  if (!(least > 0)) return 1;
  if (cost == RouteCost::time)
    for (const double seconds : {60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400})
      if (least > 30 && seconds >= least) return seconds;
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1, 2, 5})
    if (factor * power >= least) return factor * power;
  return 10 * power;
}

struct Scale {
  double size;  // of the unit in unit_of(cost)
  const char* unit;
};

Scale scale_of(RouteCost cost, double interval) {
  switch (cost) {
    case RouteCost::time:
      return interval >= 60 ? Scale{60, " min"} : Scale{1, " s"};
    case RouteCost::energy:
      return interval >= 1e5 ? Scale{1e6, " MJ"} : Scale{1e3, " kJ"};
    case RouteCost::length:
      return interval >= 100 ? Scale{1e3, " km"} : Scale{1, " m"};
    default:
      return {1, ""};
  }
}

std::string label_of(RouteCost cost, double from, double to, const Scale& scale) {
  if (cost == RouteCost::risk) return line("risk %g to %g", from, to);
  return line("%g to %g%s", from / scale.size, to / scale.size, scale.unit);
}

}  // namespace

CostBands cost_bands(RouteCost cost, const std::vector<float>& least, double interval) {
  double most = 0;
  for (const float c : least)
    if (std::isfinite(c)) most = std::max(most, double(c));
  if (!(interval >= 0) || !std::isfinite(interval))
    throw InputError(line("route: --interval: %g is not the width of a band; give a number above 0", interval));
  CostBands bands;
  bands.interval = interval > 0 ? interval : round_interval(cost, most / kWantedBands);
  const double count = std::floor(most / bands.interval) + 1;
  if (count > kMaxBands)
    throw InputError(
        line("route: --interval %g makes %.0f bands up to the largest cost of %.4g (%s); allowed are %d, "
             "so give at least %.3g",
             interval, count, most, kMeaning[std::size_t(cost)], kMaxBands, most / (kMaxBands - 1)));
  const Scale scale = scale_of(cost, bands.interval);
  for (int b = 0; b < int(count); ++b)
    bands.label.push_back(label_of(cost, b * bands.interval, (b + 1) * bands.interval, scale));
  for (const float c : least)
    bands.band.push_back(std::isfinite(c) ? std::uint8_t(std::floor(double(c) / bands.interval)) : kNoBand);
  return bands;
}

LargestRegions largest_regions(const std::vector<std::int32_t>& region) {
  LargestRegions result;
  for (const std::int32_t r : region) {
    if (r < 0) continue;
    if (std::size_t(r) >= result.cells.size()) result.cells.resize(std::size_t(r) + 1);
    ++result.cells[std::size_t(r)];
  }
  std::vector<std::size_t> order(result.cells.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return result.cells[a] > result.cells[b]; });
  std::vector<std::uint8_t> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[order[k]] = std::uint8_t(std::min(k, kMaxRegions));
  for (const std::int32_t r : region) result.rank.push_back(r < 0 ? kNoBand : rank[std::size_t(r)]);
  std::sort(result.cells.begin(), result.cells.end(), std::greater<>());
  return result;
}

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
       .metadata = metadata,
       .smooth = true});
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

ConnectedRegions write_regions(const fs::path& path, const terrain::MapGrid& grid,
                               const std::vector<std::int32_t>& region) {
  require_geopackage(path, "--regions");
  const LargestRegions regions = largest_regions(region);
  const double cell_km2 = grid.cell_area_m2() * 1e-6;
  std::vector<terrain::LegendEntry> legend;
  for (std::size_t k = 0; k < std::min(regions.cells.size(), kMaxRegions); ++k)
    legend.push_back({double(k), line("region %zu: %.4g km2", k + 1, double(regions.cells[k]) * cell_km2),
                      kRegionColours[k % kRegionColours.size()]});
  if (regions.cells.size() > kMaxRegions) legend.push_back({double(kMaxRegions), "smaller regions", "#bdbdbd"});
  terrain::write_cell_polygons(path, "regions", grid, regions.rank, legend);
  return {.count = regions.cells.size(),
          .largest = regions.cells.empty() ? 0.0 : double(regions.cells.front()) * cell_km2,
          .passable = double(std::accumulate(regions.cells.begin(), regions.cells.end(), std::uint64_t(0))) * cell_km2};
}

}  // namespace gonogo::map
