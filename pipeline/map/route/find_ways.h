// The cheapest ways over the places of a request: what they cost, and the chance to get through.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "base/json/json.h"
#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/route/any_angle.h"
#include "pipeline/map/route/plan_route.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {

/// Every cost that the model tells.
using AllCosts = std::map<RouteCost, RouteCosts>;

/// Throws InputError for a cost that is asked for and not told.
AllCosts all_costs(const SoilTable& table, const std::vector<RouteCost>& asked, double correlation_length);

/// Index of the cell under a place. Throws InputError outside the raster and where nothing drives; `option` is
/// the place's option.
std::uint32_t cell_at(const Place& place, const terrain::MapGrid& grid, const RouteCells& cells, const char* option);

/// The places to pass, as cells.
std::vector<std::uint32_t> stops_of(const RouteRequest& request, const terrain::MapGrid& grid, const RouteCells& cells);

/// A way that was found.
struct FoundWay {
  RouteCost cost;
  FoundRoute route;
  Json totals;                                   // and the forecast of the drive
  std::vector<std::array<double, 2>> weakest{};  // the weakest stretch, in the grid's coordinate system; may be empty
};

/// The cheapest way by each cost asked for: what it costs as JSON, and those that were found in `ways`.
Json find_ways(const RouteRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
               const RouteCells& cells, const AllCosts& costs, std::vector<FoundWay>& ways);

}  // namespace gonogo::map
