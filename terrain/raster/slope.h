// Slope, aspect and shaded relief of an elevation tile, in ground metres and degrees.
//
// Gradient by Horn, "Hill shading and the reflectance map", Proc. IEEE 69 (1981) 14-47, on the neighbours
//   a b c
//   d e f      row above is north, spacing dx eastward and dy southward [m]
//   g h i
//   dz/dx = ((c + 2f + i) - (a + 2d + g)) / (8 dx),   dz/dy = ((g + 2h + i) - (a + 2b + c)) / (8 dy)
//   slope = atan(hypot(dz/dx, dz/dy))
// A cell with any nodata among the nine has no slope (the rule of gdaldem without -compute_edges).
//
// Every function takes elevation with a border of one cell around the wanted window and gives the window without it.
// Cells are independent of each other, so any number of threads and any tiling gives the same bits.
#pragma once
#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// Ground distance between cell centres [m].
struct CellSize {
  double width = 1, height = 1;
};

/// Steepness [deg], 0 flat.
Tile slope_degrees(const Tile& elevation_with_border, CellSize cell, int threads = 0);

/// Direction of steepest descent [deg clockwise from north, 0 <= aspect < 360]; not-a-number where exactly flat.
Tile aspect_degrees(const Tile& elevation_with_border, CellSize cell, int threads = 0);

/// Lambertian brightness [0 dark .. 1 facing the light] for a light at `azimuth` clockwise from north and `altitude`
/// above the horizon [deg].
Tile hillshade(const Tile& elevation_with_border, CellSize cell, double azimuth, double altitude, int threads = 0);

}  // namespace gonogo::terrain
