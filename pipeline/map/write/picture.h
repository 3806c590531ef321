// A reduced copy of the layers for the figure. Its size does not grow with the raster.
#pragma once
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::map {

/// Every cell shows the map's cell under its centre.
struct Picture {
  terrain::Tile shade, verdict, reason, p_go;

  /// Sized for `grid`, with at most `longest` cells along the longer side.
  Picture(const terrain::MapGrid& grid, int longest);
};

}  // namespace gonogo::map
