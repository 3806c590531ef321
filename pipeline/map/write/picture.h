// A reduced copy of the layers for the figure: memory does not grow with the raster.
#pragma once
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::map {

/// Every cell the map's cell under its middle.
struct Picture {
  terrain::Tile shade, verdict, reason, p_go;

  /// At most `longest` cells along the longer side; never more than the grid has.
  Picture(const terrain::MapGrid& grid, int longest);
};

}  // namespace gonogo::map
