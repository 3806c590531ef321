// The cheapest ways over the places of a request: what they cost, and the chance to get through.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/route/passage.h"
#include "pipeline/map/route/plan_route.h"
#include "pipeline/map/route/search/any_angle.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {

/// Pieces of the way, one for each cell that a line crosses. `length`: costs of RouteCost::length.
std::vector<WayPiece> pieces_of(const FoundRoute& route, const RouteCells& cells, const RouteCosts& length);

/// Soils in the order of the table, by their sampled points.
std::vector<WaySoil> way_soils(const SoilTable& table);

/// What is not known on a way over the region.
PassageDoubt passage_doubt(const RegionRaster& elevation, const MapRules& rules, const terrain::MapGrid& grid);

/// Every cost that the model gives.
using AllCosts = std::map<RouteCost, RouteCosts>;

/// Throws InputError for a cost that is asked for and not given.
AllCosts all_costs(const SoilTable& table, const std::vector<RouteCost>& asked, double correlation_length);

/// Index of the cell under a place. Throws InputError outside the raster and where nothing drives; `option` is
/// the place's option.
std::uint32_t cell_at(const Place& place, const terrain::MapGrid& grid, const RouteCells& cells, const char* option);

/// The places to pass, as cells.
std::vector<std::uint32_t> stops_of(const RouteRequest& request, const terrain::MapGrid& grid, const RouteCells& cells);

/// The cheapest way by each cost asked for; nothing where there is none.
std::vector<std::pair<RouteCost, std::optional<FoundWay>>> find_ways(const RouteRequest& request,
                                                                     const terrain::MapGrid& grid,
                                                                     const SoilTable& table, const RouteCells& cells,
                                                                     const AllCosts& costs);

/// For places between which no way leads: how far eight-directional steps come, and what the next one meets. Nothing
/// where they reach every place.
std::optional<DeadEnd> find_dead_end(const RouteRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                                     const RouteCells& cells, const RouteCosts& costs);

}  // namespace gonogo::map
