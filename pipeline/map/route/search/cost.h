// Cost of a step of a route.
//
// A step goes to one of the eight neighbours. Half of it lies in each of its two cells. In a cell the heading selects a
// node of the soil's heading table (heading_table.h). The node gives the cost per metre of map distance:
//
//   length   1 / cos(along)                          [m]     on the ground
//   time     length / top speed                      [s]
//   risk     -ln P(go) length / correlation length   [-]     what the safest way has least of
//   energy   length x energy per metre               [J]     at the wheels, of a quarter vehicle at one wheel
//
// The risk of a way does not depend on the cell size. It counts stretches as independent, which they are not: the
// chance to get through is that of passage.h. A node that is neither go nor slow_go is impassable in that heading.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/soil_table.h"

namespace gonogo::map {

enum class RouteCost { length, time, risk, energy };
inline constexpr std::array<RouteCost, 4> kRouteCosts = {RouteCost::length, RouteCost::time, RouteCost::risk,
                                                         RouteCost::energy};
/// "shortest", "fastest", "safest" or "least-energy". Throws InputError for other names.
RouteCost route_cost_named(const std::string& name);
std::string name_of(RouteCost cost);
/// "m", "s", "1" or "J".
const char* unit_of(RouteCost cost);

/// Inputs of all cells of a map [cell], row by row from the north.
struct RouteCells {
  int columns = 0, rows = 0;
  double cell_width = 1, cell_height = 1;  // [m]
  std::vector<std::uint16_t> slope;        // [1 / kSlopeSteps deg]
  std::vector<std::uint16_t> aspect;       // whole degrees [0, 360), downhill, clockwise from grid north
  std::vector<std::uint8_t> soil;          // position in the soil table, or a mark
  enum Mark : std::uint8_t {
    kClosed = 254,   // no-go by a land rule, or to be avoided
    kNowhere = 255,  // no slope, unknown soil, or unknown by a land rule
  };
  bool is_open(std::size_t cell) const { return soil[cell] < kClosed; }
};

/// The eight steps, clockwise from north.
struct RouteStep {
  int column = 0, row = 0;
  int heading = 0;    // [deg clockwise from grid north], rounded to whole degrees
  double length = 0;  // map distance of the whole step [m]
};
std::array<RouteStep, 8> route_steps(double cell_width, double cell_height);

/// Node of the heading table by slope step (1 / kSlopeSteps deg) and psi [0, 360) in whole degrees. kNoNode outside the
/// sampled box.
class HeadingNodes {
 public:
  explicit HeadingNodes(const HeadingTable& table);
  std::size_t node(std::uint16_t slope_step, int psi_degrees) const {
    return node_[std::size_t(slope_step) * 360 + std::size_t(psi_degrees)];
  }
  static constexpr std::size_t kNoNode = 65535;

 private:
  std::vector<std::uint16_t> node_;  // [90 kSlopeSteps + 1][360]; 16 bits keep it in cache for the search
};

/// Costs per metre for all soils of a map. `table` is read in the constructor only.
class RouteCosts {
 public:
  /// correlation_length [m] > 0. Throws InputError for time or energy if the soils have no such measure.
  RouteCosts(const SoilTable& table, RouteCost cost, double correlation_length);

  /// Cost per metre of map distance in `cell`. heading: whole degrees [0, 360). kImpassable if it cannot be passed.
  float per_metre(const RouteCells& cells, std::size_t cell, int heading) const {
    return per_metre(cells.soil[cell], cells.slope[cell], cells.aspect[cell], heading);
  }
  float per_metre(std::uint8_t soil, std::uint16_t slope, int aspect, int heading) const {
    if (soil >= RouteCells::kClosed) return kImpassable;
    int psi = heading - aspect + 180;  // both 0 to 359
    psi += psi < 0 ? 360 : psi >= 360 ? -360 : 0;
    const std::size_t node = nodes_.node(slope, psi);
    return node == HeadingNodes::kNoNode ? kImpassable : factor_[soil][node];
  }
  /// The least of all headings.
  float least_per_metre(std::uint8_t soil, std::uint16_t slope) const {
    float least = kImpassable;
    for (int heading = 0; heading < 360; ++heading) least = std::min(least, per_metre(soil, slope, 0, heading));
    return least;
  }
  /// Whether some heading of the cell can be passed.
  bool ever_passable(const RouteCells& cells, std::size_t cell) const {
    const std::uint8_t soil = cells.soil[cell];
    return soil < RouteCells::kClosed && best_[soil][cells.slope[cell]];
  }
  std::size_t soil_count() const { return factor_.size(); }
  /// No cell that can be passed costs less per metre.
  float least_per_metre() const { return least_; }
  static constexpr float kImpassable = std::numeric_limits<float>::infinity();

 private:
  float least_ = kImpassable;
  HeadingNodes nodes_;
  std::vector<std::vector<float>> factor_;  // [soil][node]
  std::vector<std::vector<char>> best_;     // [soil][slope step]
};

/// The cells of a map as searches read them: all that a cost depends on lies in one word.
class PackedCells {
 public:
  /// Both must outlive this.
  PackedCells(const RouteCells& cells, const RouteCosts& costs);

  std::size_t size() const { return word_.size(); }
  /// Whether some heading passes the cell.
  bool passable(std::size_t cell) const { return word_[cell] >> 31; }
  /// As RouteCosts::per_metre().
  float per_metre(std::size_t cell, int heading) const {
    const std::uint32_t word = word_[cell];
    return costs_.per_metre(soil(word), slope(word), int(word % kAspects), heading);
  }
  /// No heading costs less. 0 in a cell that is not passable, such as a start that was closed.
  float least_per_metre(std::size_t cell) const { return passable(cell) ? least_[row(word_[cell])] : 0; }

 private:
  static constexpr std::uint32_t kAspects = 1 << 9, kSlopes = 1 << 13;
  static std::uint32_t row(std::uint32_t word) { return word % (1u << 31) / kAspects; }  // of a soil and a slope
  static std::uint8_t soil(std::uint32_t word) { return std::uint8_t(row(word) / kSlopes); }
  static std::uint16_t slope(std::uint32_t word) { return std::uint16_t(row(word) % kSlopes); }

  const RouteCosts& costs_;
  std::vector<std::uint32_t> word_;  // [cell] passable, soil, slope and aspect, from the highest bit on
  std::vector<float> least_;         // [row]
};

}  // namespace gonogo::map
