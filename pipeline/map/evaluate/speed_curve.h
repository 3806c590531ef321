// Speed made good over the region: how much of the known area can be crossed how fast. Cells that cannot be passed
// count with speed 0; unknown cells are left out and counted apart.
#pragma once
#include <array>
#include <cstdint>
#include <string>

namespace gonogo::map {

class SpeedCurve {
 public:
  static constexpr double kStep = 0.01;  // [m/s] width of a class of speeds
  static constexpr int kSteps = 4096;    // faster counts as the fastest class
  /// Position of a speed [m/s] among the classes; 0 only for cells that cannot be passed.
  static int step_of(double speed);

  void add(int step, std::uint64_t cells) { cells_[std::size_t(step)] += cells; }
  void add_unknown(std::uint64_t cells) { unknown_ += cells; }

  /// Columns percent_of_known_area (1 to 100), slowest_m_s: speed that the best so many percent reach at least,
  /// mean_m_s: their mean along a way with as much of every cell (harmonic), the V50 of mobility studies at 50. A last
  /// line tells the share of unknown cells.
  std::string csv() const;

 private:
  std::array<std::uint64_t, kSteps> cells_{};
  std::uint64_t unknown_ = 0;
};

}  // namespace gonogo::map
