// Speed curve of a region: which share of the known area can be crossed at which speed. Impassable cells count with
// speed 0. Unknown cells are counted separately.
#pragma once
#include <array>
#include <cstdint>
#include <string>

namespace gonogo::map {

class SpeedCurve {
 public:
  static constexpr double kStep = 0.01;  // [m/s] width of a class of speeds
  static constexpr int kSteps = 4096;    // number of classes; faster cells count in the last one
  /// Class of a speed [m/s]. Class 0 is for impassable cells only.
  static int step_of(double speed);

  void add(int step, std::uint64_t cells) { cells_[std::size_t(step)] += cells; }
  void add_unknown(std::uint64_t cells) { unknown_ += cells; }

  /// One line for each percent_of_known_area p from 1 to 100, fastest cells first. slowest_km_h is the min speed of the
  /// fastest p percent. mean_km_h is their harmonic mean, called V50 at p = 50 in mobility studies. The last line gives
  /// the share of unknown cells.
  std::string csv() const;

 private:
  std::array<std::uint64_t, kSteps> cells_{};
  std::uint64_t unknown_ = 0;
};

}  // namespace gonogo::map
