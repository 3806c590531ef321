// Cells under the lines and polygons of vector files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// 1 for each cell that a polygon of the file touches, 0 elsewhere [cell]. Any vector format of open_file.h, in any
/// coordinate system. Curves become chords of 1 degree; collections, surfaces of triangles and of polygons become
/// their parts. Throws InputError: no such file, no vector file, a damaged one, no coordinate system, other shapes than
/// polygons, no polygon on the grid.
std::vector<std::uint8_t> cells_under(const std::filesystem::path& file, const MapGrid& grid);

/// What becomes of a feature: the number of its cells, and the width of a line on the ground [m].
struct ShapeMark {
  float value = 0;   // 0: the feature marks no cell
  double width = 0;  // 0: every cell that the line touches
  int rank = 0;      // the higher one wins in a cell; of equal ones the later
};

/// A numeric attribute of a feature by name; throws InputError where the feature has none, or a text.
using FeatureNumbers = std::function<double(const std::string& attribute)>;

/// Cells under lines and polygons, window by window. Each feature has a number of its own.
class ShapeCells {
 public:
  explicit ShapeCells(const MapGrid& grid);
  ShapeCells(ShapeCells&&) noexcept;
  ~ShapeCells();

  /// Takes the lines and polygons of a file, read as in cells_under(). `layer`: empty for all of them. `mark` is asked
  /// once for each feature. Throws InputError also for points, and where there is no such layer.
  void add(const std::filesystem::path& file, const std::string& layer,
           const std::function<ShapeMark(const FeatureNumbers&)>& mark);

  /// One sentence each, without a full stop: datums whose way to the map's is not known.
  const std::vector<std::string>& remarks() const;

  /// Numbers of the cells that a shape touches, 0 elsewhere. The split into windows changes no cell. Thread-safe.
  Tile read(Window window) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gonogo::terrain
