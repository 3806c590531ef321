// A reduced copy of the layers for the figure, filled while the map streams by: memory does not grow with the raster.
#pragma once
#include "terrain/raster/grid.h"

namespace gonogo::pipeline {

/// The layers of one block of rows, all of the window's size.
struct BlockLayers {
  terrain::Window window;
  terrain::Tile shade, verdict, reason, p_go, outside_share;
  terrain::Tile soil;  // position in the soil table, -1 unknown
};

struct Picture {
  terrain::Tile shade, verdict, reason, p_go;  // every cell the map's cell under its middle

  /// At most `longest` cells along the longer side; never more than the grid has.
  Picture(const terrain::MapGrid& grid, int longest);
  void take(const terrain::MapGrid& grid, const BlockLayers& block);
};

}  // namespace gonogo::pipeline
