// Finds large areas of exactly one height, row by row. Only for the .cpp files of this folder.
#pragma once
#include <array>

#include "terrain/raster/height_scan.h"

namespace gonogo::terrain {

class FlatAreas {
 public:
  FlatAreas(int columns, double cell_area) : columns_(columns), cell_area_(cell_area) {}

  /// The next row [columns]; NaN: no height.
  void take(const std::vector<float>& row);
  /// Moves what was found into `scan`. Call once, after the last of `rows` rows.
  void finish(int rows, HeightScan& scan);

 private:
  struct Run {
    int begin, end, area;
  };
  /// A connected area that may still grow.
  struct Area {
    float value = 0;
    std::uint64_t cells = 0, higher = 0, lower = 0;  // borders with higher and lower cells
    std::vector<std::array<int, 3>> runs = {};       // row, begin, end
  };
  std::vector<Run> runs_in(const std::vector<float>& row) const;
  void join(std::vector<Run>& runs, const std::vector<float>& row);
  void count_borders(const std::vector<Run>& runs, const std::vector<float>& own, const std::vector<float>& other);
  void count_ends(const std::vector<Run>& runs, const std::vector<float>& own);
  void retire(Area&& area);

  int columns_, row_ = 0;
  double cell_area_;
  bool whole_numbers_ = true;
  std::vector<float> above_;
  std::vector<Run> open_;    // runs of the row above
  std::vector<Area> areas_;  // those of open_
  std::vector<Area> large_;  // finished
};

}  // namespace gonogo::terrain
