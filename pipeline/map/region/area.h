// How much of a region has which class, reason and speed.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "base/json/json.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::map {

/// Number of cells of a region by class and reason.
class AreaCount {
 public:
  void add(campaign::Verdict verdict, campaign::Reason reason, std::uint64_t cells = 1) {
    cells_[{verdict, reason}] += cells;
  }

  std::uint64_t total() const;
  std::uint64_t cells(campaign::Verdict verdict) const;
  std::uint64_t cells(campaign::Verdict verdict, campaign::Reason reason) const;
  /// Share of all counted cells [0, 1]; 0 if none were counted. A map counts the cells that have a slope.
  double share(campaign::Verdict verdict) const;
  double share(campaign::Verdict verdict, campaign::Reason reason) const;

  /// Columns class, reason, cells, area_km2, share. Classes in the contract's order, each followed by its reasons that
  /// occur.
  std::string csv(double cell_area_m2) const;
  Json to_json() const;
  static AreaCount from_json(const Json& json);

 private:
  std::map<std::pair<campaign::Verdict, campaign::Reason>, std::uint64_t> cells_;
};

/// Speed curve of a region: which share of the known area can be crossed at which speed. Impassable cells count with
/// speed 0. Unknown cells are counted separately.
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
