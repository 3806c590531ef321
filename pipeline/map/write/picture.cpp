#include "pipeline/map/write/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonogo::map {

using terrain::MapGrid;
using terrain::Tile;

Picture::Picture(const MapGrid& grid, int longest) {
  const double scale = std::min(1.0, double(longest) / std::max(grid.columns, grid.rows));
  const int columns = std::max(1, int(std::lround(grid.columns * scale)));
  const int rows = std::max(1, int(std::lround(grid.rows * scale)));
  shade = verdict = reason = p_go = Tile(columns, rows, std::numeric_limits<float>::quiet_NaN());
}

}  // namespace gonogo::map
