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
    const std::uint8_t soil = cells.soil[cell];
    if (soil >= RouteCells::kClosed) return kImpassable;
    int psi = heading - cells.aspect[cell] + 180;  // both 0 to 359
    psi += psi < 0 ? 360 : psi >= 360 ? -360 : 0;
    const std::size_t node = nodes_.node(cells.slope[cell], psi);
    return node == HeadingNodes::kNoNode ? kImpassable : factor_[soil][node];
  }
  /// Whether some heading of the cell can be passed.
  bool ever_passable(const RouteCells& cells, std::size_t cell) const {
    const std::uint8_t soil = cells.soil[cell];
    return soil < RouteCells::kClosed && best_[soil][cells.slope[cell]];
  }
  /// No cell that can be passed costs less per metre.
  float least_per_metre() const { return least_; }
  static constexpr float kImpassable = std::numeric_limits<float>::infinity();

 private:
  float least_ = kImpassable;
  HeadingNodes nodes_;
  std::vector<std::vector<float>> factor_;  // [soil][node]
  std::vector<std::vector<char>> best_;     // [soil][slope step]
};

}  // namespace gonogo::map
