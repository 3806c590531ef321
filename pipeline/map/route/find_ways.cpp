#include "pipeline/map/route/find_ways.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/map/route/search/search.h"
#include "pipeline/map/route/search/turning.h"
#include "pipeline/map/route/way_files.h"

namespace gonogo::map {

std::vector<WayPiece> pieces_of(const FoundRoute& route, const RouteCells& cells, const RouteCosts& length) {
  std::vector<WayPiece> pieces;
  double driven = 0;
  const auto columns = std::uint32_t(cells.columns);
  for (std::size_t i = 1; i < route.cell.size(); ++i) {
    const LineOfCells line(cells, route.cell[i - 1], route.cell[i]);
    walk_line(cells.columns, route.cell[i - 1], route.cell[i], [&](std::uint32_t cell, double begin, double end) {
      const double rise = std::tan(cells.slope[cell] / kSlopeSteps * kDegree);
      const double downhill = cells.aspect[cell] * kDegree;
      const double next = driven + line.length * (end - begin) * double(length.per_metre(cells, cell, line.heading));
      pieces.push_back({.begin = driven,
                        .end = next,
                        .soil = cells.soil[cell],
                        .rise_east = -rise * std::sin(downhill),
                        .rise_north = -rise * std::cos(downhill),
                        .heading = double(line.heading),
                        .column = int(cell % columns),
                        .row = int(cell / columns)});
      driven = next;
      return true;
    });
  }
  return pieces;
}

namespace {

/// The line over pieces `first` to `last`, in the grid's coordinate system.
std::vector<std::array<double, 2>> line_over(const FoundRoute& route, const terrain::MapGrid& grid, std::size_t first,
                                             std::size_t last) {
  std::vector<std::array<double, 2>> line;
  std::size_t piece = 0;
  for (std::size_t i = 1; i < route.cell.size(); ++i) {
    const terrain::TrackPoint a = centre_of(route.cell[i - 1], grid), b = centre_of(route.cell[i], grid);
    const auto add = [&](double share) { line.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)}); };
    walk_line(grid.columns, route.cell[i - 1], route.cell[i], [&](std::uint32_t, double begin, double end) {
      if (piece == first) add(begin);
      if (piece >= first && piece <= last) add(end);
      ++piece;
      return true;
    });
  }
  return line;
}

}  // namespace

PassageDoubt passage_doubt(const RegionRaster& elevation, const MapRules& rules, const terrain::MapGrid& grid) {
  return {.bed_length = rules.correlation_length,
          .height_error = elevation.error * std::sqrt(1 - elevation.error_correlation),
          .cell_width = grid.cell_width_m(),
          .cell_height = grid.cell_height_m()};
}

std::vector<WaySoil> way_soils(const SoilTable& table) {
  std::vector<WaySoil> soils;
  for (std::size_t s = 0; s < table.responses.size(); ++s) {
    const SoilPoints& points = table.responses[s].points();
    const std::size_t count = points.sampled_count();
    WaySoil soil{.name = s < table.soils.size() ? table.soils[s].name : std::string(), .points = {}};
    const std::size_t variables = count > 0 ? points.sampled().size() / count : 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = points.sampled().subspan(i * variables, variables);
      soil.points.emplace_back(row.begin(), row.end());
    }
    soil.not_sampled = 1 - double(count) / double(points.all().size());
    soils.push_back(std::move(soil));
  }
  return soils;
}

namespace {

/// Cost of a way by another measure than the one it was found with.
double cost_along(const FoundRoute& route, const RouteCells& cells, const RouteCosts& costs) {
  double sum = 0;
  for (std::size_t i = 1; i < route.cell.size(); ++i) sum += line_cost(cells, costs, route.cell[i - 1], route.cell[i]);
  return sum;
}

/// The cheapest way over all stops; nothing if one cannot be reached from the one before.
std::optional<FoundRoute> way_over(const std::vector<std::uint32_t>& stops, const RouteRequest& request,
                                   const RouteCells& cells, const RouteCosts& costs) {
  if (request.turning > 0) return find_turning(cells, costs, Turning(cells, costs, request.turning), stops);
  FoundRoute whole{0, {stops.front()}};
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const auto leg = request.eight_directions ? find_route(cells, costs, stops[i - 1], stops[i])
                                              : find_any_angle(cells, costs, stops[i - 1], stops[i]);
    if (!leg) return std::nullopt;
    whole.cost += leg->cost;
    whole.cell.insert(whole.cell.end(), leg->cell.begin() + 1, leg->cell.end());
  }
  return whole;
}

/// The chance to get through, and the weakest stretch.
Passage passage_over(const FoundRoute& route, const MapRequest& map, const terrain::MapGrid& grid,
                     const RouteCells& cells, const RouteCosts& length, const std::vector<WaySoil>& soils) {
  const auto pieces = pieces_of(route, cells, length);
  const PassageForecast forecast =
      forecast_passage(pieces, soils, map.model, passage_doubt(map.region.elevation, map.rules, grid));
  Passage passage{forecast.chance, forecast.error, forecast.places, forecast.not_sampled, {}};
  if (!forecast.weakest) return passage;
  const WeakestStretch& stretch = *forecast.weakest;
  const WayPiece& piece = pieces[stretch.piece];
  const SlopesOnWay slopes = slopes_on_way(piece);
  passage.weakest = {.begin = stretch.begin,
                     .end = stretch.end,
                     .stuck = stretch.stuck,
                     .reason = campaign::contract().info(campaign::contract().outcomes[stretch.outcome].reason).label,
                     .soil = soils[piece.soil].name,
                     .slope_along = to_degrees(std::atan(slopes.along)),
                     .slope_across = to_degrees(std::atan(slopes.across)),
                     .line = line_over(route, grid, stretch.first, stretch.last)};
  return passage;
}

}  // namespace

AllCosts all_costs(const SoilTable& table, const std::vector<RouteCost>& asked, double correlation_length) {
  const auto& measures = table.responses.front().measures();
  AllCosts costs;
  for (const RouteCost cost : kRouteCosts) {
    const bool told = cost == RouteCost::time     ? table.responses.front().has_speed()
                      : cost == RouteCost::energy ? measures.count("energy_per_metre") > 0
                                                  : true;
    const bool wanted = std::find(asked.begin(), asked.end(), cost) != asked.end();
    if (told || wanted) costs.emplace(cost, RouteCosts(table, cost, correlation_length));  // refuses what is not told
  }
  return costs;
}

std::uint32_t cell_at(const Place& place, const terrain::MapGrid& grid, const RouteCells& cells, const char* option) {
  const double column = std::floor((place.x - grid.west) / grid.cell_width);
  const double row = std::floor((grid.north - place.y) / grid.cell_height);
  if (!(column >= 0 && column < grid.columns && row >= 0 && row < grid.rows))
    throw InputError(
        line("route: %s %.10g,%.10g lies outside the elevation raster, which covers %.10g to %.10g and "
             "%.10g to %.10g; give coordinates in its system",
             option, place.x, place.y, grid.west, grid.east(), grid.south(), grid.north));
  const auto cell = std::uint32_t(row) * std::uint32_t(grid.columns) + std::uint32_t(column);
  if (!cells.is_open(cell))
    throw InputError(
        line("route: %s %.10g,%.10g has no elevation or no known soil, or is closed by land cover or a polygon to "
             "avoid; choose "
             "a place next to it",
             option, place.x, place.y));
  return cell;
}

std::vector<std::uint32_t> stops_of(const RouteRequest& request, const terrain::MapGrid& grid,
                                    const RouteCells& cells) {
  std::vector<std::uint32_t> stops = {cell_at(*request.from, grid, cells, "--from")};
  for (const Place& place : request.via) stops.push_back(cell_at(place, grid, cells, "--via"));
  stops.push_back(cell_at(*request.to, grid, cells, "--to"));
  return stops;
}

std::vector<std::pair<RouteCost, std::optional<FoundWay>>> find_ways(const RouteRequest& request,
                                                                     const terrain::MapGrid& grid,
                                                                     const SoilTable& table, const RouteCells& cells,
                                                                     const AllCosts& costs) {
  const std::vector<std::uint32_t> stops = stops_of(request, grid, cells);
  const std::vector<WaySoil> soils = way_soils(table);
  std::vector<std::pair<RouteCost, std::optional<FoundWay>>> ways;
  for (const RouteCost cost : request.costs) {
    const auto found = way_over(stops, request, cells, costs.at(cost));
    ways.emplace_back(cost, std::nullopt);
    if (!found) continue;
    const auto total = [&](RouteCost by) { return cost_along(*found, cells, costs.at(by)); };
    FoundWay way{cost, *found};
    way.length = total(RouteCost::length);
    way.risk = total(RouteCost::risk);
    if (costs.count(RouteCost::time)) way.time = total(RouteCost::time);
    if (costs.count(RouteCost::energy)) way.energy = total(RouteCost::energy);
    way.passage = passage_over(*found, request.map, grid, cells, costs.at(RouteCost::length), soils);
    if (request.turning > 0) {
      way.turned = Turning(cells, costs.at(cost), request.turning).turns(found->cell).degrees;
      way.turning = *way.turned / 90 * request.turning;
    }
    ways.back().second = std::move(way);
  }
  return ways;
}

namespace {

/// What a vehicle meets that enters a cell on a heading [deg].
std::string obstruction(const SoilTable& table, const RouteCells& cells, std::size_t cell, int heading) {
  const std::uint8_t soil = cells.soil[cell];
  if (soil == RouteCells::kClosed) return "land cover, an obstacle or a polygon to avoid";
  if (soil == RouteCells::kNowhere) return "ground without elevation, soil or known land cover";
  const double slope = cells.slope[cell] / double(kSlopeSteps), psi = fall_line_angle(heading, cells.aspect[cell]);
  const CellClass& result = table.responses[soil].at(slope, psi).result;
  const auto& contract = campaign::contract();
  return contract.info(result.verdict).label + " for " + contract.info(result.reason).label +
         line(" on %s at %.0f degrees of slope", table.soils[soil].name.c_str(), slope);
}

}  // namespace

std::optional<DeadEnd> find_dead_end(const RouteRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                                     const RouteCells& cells, const RouteCosts& costs) {
  const std::vector<std::uint32_t> stops = stops_of(request, grid, cells);
  const auto columns = std::size_t(cells.columns);
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const std::vector<float> cost = reach(cells, costs, stops[i - 1]);
    const std::size_t goal = stops[i];
    if (std::isfinite(cost[goal])) continue;
    const auto across = [&](std::size_t cell) { return double(goal % columns) - double(cell % columns); };
    const auto down = [&](std::size_t cell) { return double(goal / columns) - double(cell / columns); };
    std::size_t nearest = stops[i - 1];
    const auto distance = [&](std::size_t cell) {
      return std::hypot(across(cell) * cells.cell_width, down(cell) * cells.cell_height);
    };
    for (std::size_t cell = 0; cell < cost.size(); ++cell)
      if (std::isfinite(cost[cell]) && distance(cell) < distance(nearest)) nearest = cell;
    const double longest = std::max(std::abs(across(nearest)), std::abs(down(nearest)));
    const int right = int(std::lround(across(nearest) / longest)), below = int(std::lround(down(nearest) / longest));
    const std::size_t next = std::size_t(std::ptrdiff_t(nearest) + below * std::ptrdiff_t(columns) + right);
    const int heading = (int(std::lround(to_degrees(std::atan2(right, -below)))) + 360) % 360;
    return DeadEnd{.place = {grid.west + (double(nearest % columns) + 0.5) * grid.cell_width,
                             grid.north - (double(nearest / columns) + 0.5) * grid.cell_height},
                   .short_of = distance(nearest),
                   .by = obstruction(table, cells, next, heading)};
  }
  return std::nullopt;
}

}  // namespace gonogo::map
