#include "terrain/raster/layer/slope.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/units.h"

namespace gonogo::terrain {
namespace {

/// Eastward and southward rise per metre; NaN next to nodata, which any of the nine values passes on.
struct Gradient {
  double east, south;
};

Gradient horn_gradient(const float* north, const float* here, const float* south, CellSize cell) {
  const double a = north[0], b = north[1], c = north[2], d = here[0], f = here[2], g = south[0], h = south[1],
               i = south[2];
  const double centre_nan_passes_on = 0.0 * here[1];
  return {((c + 2 * f + i) - (a + 2 * d + g)) / (8 * cell.width) + centre_nan_passes_on,
          ((g + 2 * h + i) - (a + 2 * b + c)) / (8 * cell.height)};
}

template <class Formula>
Tile for_each_cell(const Tile& elevation, CellSize cell, int threads, const Formula& formula) {
  GONOGO_ASSERT(elevation.columns >= 2 && elevation.rows >= 2);
  Tile out(elevation.columns - 2, elevation.rows - 2, kNoData);
  const auto row_of = [&](std::size_t index) {
    const int row = int(index);
    const float* north = &elevation.value[std::size_t(row) * elevation.columns];
    const float* here = north + elevation.columns;
    const float* south = here + elevation.columns;
    for (int column = 0; column < out.columns; ++column)
      out.at(column, row) = formula(horn_gradient(north + column, here + column, south + column, cell));
  };
  for_each_on_host(std::size_t(out.rows), 16, row_of, threads);
  return out;
}

}  // namespace

Tile slope_degrees(const Tile& elevation, CellSize cell, int threads) {
  return for_each_cell(elevation, cell, threads,
                       [](Gradient g) { return float(std::atan(std::hypot(g.east, g.south)) * kDegreesPerRadian); });
}

Tile aspect_degrees(const Tile& elevation, CellSize cell, int threads) {
  return for_each_cell(elevation, cell, threads, [](Gradient g) {
    if (g.east == 0 && g.south == 0) return kNoData;
    // Downslope is (-east, +south); azimuth = atan2(eastward, northward).
    const float azimuth = float(std::atan2(-g.east, g.south) * kDegreesPerRadian);
    const float turned = azimuth < 0 ? azimuth + 360.0f : azimuth;
    return turned >= 360.0f ? 0.0f : turned;
  });
}

Tile hillshade(const Tile& elevation, CellSize cell, double azimuth, double altitude, int threads) {
  const double up = std::sin(altitude / kDegreesPerRadian), level = std::cos(altitude / kDegreesPerRadian);
  const double east = level * std::sin(azimuth / kDegreesPerRadian),
               south = -level * std::cos(azimuth / kDegreesPerRadian);
  return for_each_cell(elevation, cell, threads, [=](Gradient g) {
    // The surface normal is (-dz/dx, -dz/dy, 1) / length; brightness its product with the direction to the light.
    const double brightness =
        (up - g.east * east - g.south * south) / std::sqrt(1 + g.east * g.east + g.south * g.south);
    return std::isnan(brightness) ? kNoData : float(std::max(0.0, brightness));
  });
}

}  // namespace gonogo::terrain
