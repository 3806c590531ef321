// A reduced copy of the layers for the figure, filled while the map streams by: memory does not grow with the raster.
#pragma once
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::pipeline {

/// One block of rows, all tiles of the window's size.
struct BlockLayers {
  terrain::Window window;
  terrain::Tile elevation, slope, aspect, shade;
  terrain::Tile soil;                // position in the soil table, -1 unknown
  std::vector<terrain::Tile> layer;  // as map_layers() lists them
  const terrain::Tile& verdict() const { return layer[0]; }
  const terrain::Tile& p_go() const { return layer[1]; }
  const terrain::Tile& reason() const { return layer[2]; }
};

struct Picture {
  terrain::Tile shade, verdict, reason, p_go;  // every cell the map's cell under its middle

  /// At most `longest` cells along the longer side; never more than the grid has.
  Picture(const terrain::MapGrid& grid, int longest);
  void take(const terrain::MapGrid& grid, const BlockLayers& block);
};

}  // namespace gonogo::pipeline
