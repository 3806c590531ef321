#include "pipeline/map/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonogo::pipeline {

using terrain::MapGrid;
using terrain::Tile;

Picture::Picture(const MapGrid& grid, int longest) {
  const double scale = std::min(1.0, double(longest) / std::max(grid.columns, grid.rows));
  const int columns = std::max(1, int(std::lround(grid.columns * scale)));
  const int rows = std::max(1, int(std::lround(grid.rows * scale)));
  shade = verdict = reason = p_go = Tile(columns, rows, std::numeric_limits<float>::quiet_NaN());
}

void Picture::take(const MapGrid& grid, const BlockLayers& block) {
  for (int row = 0; row < shade.rows; ++row) {
    const int from_row = int((row + 0.5) * grid.rows / shade.rows) - block.window.row;
    if (from_row < 0 || from_row >= block.window.rows) continue;
    for (int column = 0; column < shade.columns; ++column) {
      const int from_column = int((column + 0.5) * grid.columns / shade.columns) - block.window.column;
      if (from_column < 0 || from_column >= block.window.columns) continue;
      shade.at(column, row) = block.shade.at(from_column, from_row);
      verdict.at(column, row) = block.verdict().at(from_column, from_row);
      reason.at(column, row) = block.reason().at(from_column, from_row);
      p_go.at(column, row) = block.p_go().at(from_column, from_row);
    }
  }
}

}  // namespace gonogo::pipeline
