#include "pipeline/map/region/region_share.h"

#include <cmath>
#include <map>

#include "terrain/raster/raster_source.h"
#include "terrain/raster/slope.h"

namespace gonogo::map {
namespace {

using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;

constexpr int kDraws = 64;  // points of a soil
constexpr int kRowsAtOnce = 256;

bool holds(const campaign::SampledVariable& range, double value) {
  return value >= range.minimum && value <= range.maximum;
}

/// Share of the soil's points whose known variables lie inside.
double share_of_soil(const Region& region, const Soil& soil, const campaign::DesignSpec& spec) {
  const std::vector<std::vector<double>> points = soil_points(region, soil, {}, kDraws);
  std::size_t inside = 0;
  for (const std::vector<double>& point : points) {
    bool all = true;
    for (const campaign::SampledVariable& range : spec.ranges)
      all = all && (std::isnan(point[range.variable]) || holds(range, point[range.variable]));
    inside += all;
  }
  return points.empty() ? 0 : double(inside) / double(points.size());
}

/// Whether a slope, uphill, and none across lie inside.
bool holds_slope(const campaign::DesignSpec& spec, double slope) {
  const std::size_t along = campaign::contract().variable_index("slope_along"),
                    across = campaign::contract().variable_index("slope_across");
  for (const campaign::SampledVariable& range : spec.ranges) {
    if (range.variable == along && !holds(range, slope)) return false;
    if (range.variable == across && !holds(range, 0)) return false;
  }
  return true;
}

}  // namespace

double share_inside(const Region& region, const campaign::DesignSpec& spec) {
  const RasterSource elevation =
      RasterSource::open_heights(region.elevation.files, region.grid, region.elevation.heights);
  const terrain::MapGrid& grid = elevation.grid();
  std::optional<RasterSource> soils;
  if (region.soil_class) soils = RasterSource::open_on_grid(region.soil_class->files, grid, RasterKind::classes);
  std::map<int, double> share_of_code;
  for (const Soil& soil : region.soils) share_of_code[soil.code] = share_of_soil(region, soil, spec);
  const double everywhere = share_of_soil(region, Soil{}, spec);
  double inside = 0, cells = 0;
  for (int row = 0; row < grid.rows; row += kRowsAtOnce) {
    const int rows = std::min(kRowsAtOnce, grid.rows - row);
    const Tile slope = terrain::slope_degrees(elevation.read({-1, row - 1, grid.columns + 2, rows + 2}),
                                              {grid.cell_width_m(), grid.cell_height_m()});
    Tile codes;
    if (soils) codes = soils->read({0, row, grid.columns, rows});
    for (std::size_t i = 0; i < slope.value.size(); ++i) {
      if (std::isnan(slope.value[i])) continue;
      ++cells;
      if (!holds_slope(spec, slope.value[i])) continue;
      if (!soils) {
        inside += everywhere;
      } else if (!std::isnan(codes.value[i])) {
        const auto found = share_of_code.find(int(std::lround(codes.value[i])));
        if (found != share_of_code.end()) inside += found->second;
      }
    }
  }
  return cells > 0 ? inside / cells : 0;
}

}  // namespace gonogo::map
