// Cheapest ways that count their turns.
//
// A turn is made on the spot in the cell of a corner, to the left or to the right, whichever costs less. A turn by 90
// degrees costs as much as driving `quarter` metres there: the cost per metre of each heading on the way counts by its
// share of the angle. A heading that cannot be passed cannot be turned through, such as one along a steep side slope.
//
// The search is A* over (cell, direction) with the 32 directions of any_angle.h and turns from one direction to the
// next. What remains without any turn, from reach_any_angle() backwards, is the lower bound of what remains with them.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/map/route/search/cost.h"
#include "pipeline/map/route/search/search.h"

namespace gonogo::map {

struct Turn {
  double cost = 0;     // [unit_of(cost)]; infinite if neither side can be turned to
  double degrees = 0;  // of the cheaper side [0, 360)
};

/// What a quarter turn costs, and the directions between which costs are taken as linear.
class Turning {
 public:
  /// quarter [m] > 0.
  Turning(const RouteCells& cells, const RouteCosts& costs, double quarter);

  /// The turn in `cell` between two headings in whole degrees [0, 360).
  Turn turn(std::uint32_t cell, int from, int to) const;
  /// All turns of a way over corners.
  Turn turns(const std::vector<std::uint32_t>& corner) const;
  /// Cost of the turn between two headings with no direction between them, `degrees` apart.
  double piece(std::uint32_t cell, int from, int to, int degrees) const {
    const double both = double(costs_.per_metre(cells_, cell, from)) + double(costs_.per_metre(cells_, cell, to));
    return degrees == 0 ? 0 : quarter_ / 90 * degrees * both / 2;
  }
  /// The 32 directions [deg clockwise from grid north], rising.
  const std::vector<int>& directions() const { return direction_; }

 private:
  Turn clockwise(std::uint32_t cell, int from, int to) const;

  const RouteCells& cells_;
  const RouteCosts& costs_;
  double quarter_;
  std::vector<int> direction_;
};

/// Cost of all lines and turns of a way over corners.
double cost_with_turns(const RouteCells& cells, const RouteCosts& costs, const Turning& turning,
                       const std::vector<std::uint32_t>& corner);

/// The cheapest way over all stops [cell] in the 32 directions: FoundRoute::cell holds the stops and the corners. A
/// vehicle starts in any direction and turns at a stop as at any corner. Nothing if there is no way.
std::optional<FoundRoute> search_turning(const RouteCells& cells, const RouteCosts& costs, const Turning& turning,
                                         const std::vector<std::uint32_t>& stops);

/// The same, straightened: corners are left out or moved to neighbouring cells while that makes the way cheaper. So is
/// the way of find_any_angle(), and the cheaper one of both is taken.
std::optional<FoundRoute> find_turning(const RouteCells& cells, const RouteCosts& costs, const Turning& turning,
                                       const std::vector<std::uint32_t>& stops);

}  // namespace gonogo::map
