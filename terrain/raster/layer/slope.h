// Slope, aspect and shaded relief of an elevation tile, in ground metres and degrees.
//
// Gradient by Horn, "Hill shading and the reflectance map", Proc. IEEE 69 (1981) 14-47, on the neighbours
//   a b c
//   d e f      row above is north, spacing dx eastward and dy southward [m]
//   g h i
//   dz/dx = ((c + 2f + i) - (a + 2d + g)) / (8 dx),   dz/dy = ((g + 2h + i) - (a + 2b + c)) / (8 dy)
//   slope = atan(hypot(dz/dx, dz/dy))
// A cell has no slope if any of the nine is nodata, as in gdaldem without -compute_edges.
//
// Every function takes elevation with a border of one cell and returns the window without the border. Cells are
// independent, so the bits do not depend on threads or tiling.
#pragma once
#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// Ground distance between cell centres [m].
struct CellSize {
  double width = 1, height = 1;
};

/// Slope angle [deg]; 0 is flat.
Tile slope_degrees(const Tile& elevation_with_border, CellSize cell, int threads = 0);

/// Direction of steepest descent [deg clockwise from north, 0 <= aspect < 360]; NaN where exactly flat.
Tile aspect_degrees(const Tile& elevation_with_border, CellSize cell, int threads = 0);

/// Lambertian brightness from 0 (dark) to 1 (faces the light). The light stands at `azimuth` clockwise from north and
/// `altitude` above the horizon [deg].
Tile hillshade(const Tile& elevation_with_border, CellSize cell, double azimuth, double altitude, int threads = 0);

}  // namespace gonogo::terrain
