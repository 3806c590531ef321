#include "pipeline/map/route/find_ways.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/map/route/drive_of_way.h"
#include "pipeline/map/route/search.h"
#include "pipeline/map/route/turning.h"

namespace gonogo::map {
namespace {

/// Cost of a way by another measure than the one it was found with.
double cost_along(const FoundRoute& route, const RouteCells& cells, const RouteCosts& costs) {
  double sum = 0;
  for (std::size_t i = 1; i < route.cell.size(); ++i) sum += line_cost(cells, costs, route.cell[i - 1], route.cell[i]);
  return sum;
}

Json totals_of(const FoundRoute& route, const RouteCells& cells, const AllCosts& costs) {
  const auto total = [&](RouteCost cost) { return cost_along(route, cells, costs.at(cost)); };
  Json json = Json::object();
  json["length_m"] = total(RouteCost::length);
  json["risk"] = total(RouteCost::risk);
  if (costs.count(RouteCost::time)) json["time_s"] = total(RouteCost::time);
  if (costs.count(RouteCost::energy)) json["energy_j"] = total(RouteCost::energy);
  return json;
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

/// Adds the chance to get through, the places where one gets stuck, and the weakest stretch.
void add_forecast(const MapRequest& map, const terrain::MapGrid& grid, const RouteCells& cells, const AllCosts& costs,
                  const std::vector<DriveSoil>& soils, FoundWay& found) {
  const auto pieces = pieces_of(found.route, cells, costs.at(RouteCost::length));
  const DriveForecast forecast =
      forecast_drive(pieces, soils, map.model, drive_doubt(map.region.elevation, map.rules, grid));
  const Json json = forecast_json(forecast, pieces, soils);
  for (const auto& [key, value] : json.members()) found.totals[key] = value;
  if (forecast.weakest) found.weakest = line_over(found.route, grid, forecast.weakest->first, forecast.weakest->last);
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
             option, place.x, place.y, grid.west, grid.west + grid.columns * grid.cell_width,
             grid.north - grid.rows * grid.cell_height, grid.north));
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

Json find_ways(const RouteRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
               const RouteCells& cells, const AllCosts& costs, std::vector<FoundWay>& ways) {
  const std::vector<std::uint32_t> stops = stops_of(request, grid, cells);
  const std::vector<DriveSoil> soils = drive_soils(table);
  Json routes = Json::array();
  for (const RouteCost cost : request.costs) {
    const auto found = way_over(stops, request, cells, costs.at(cost));
    Json entry = Json::object();
    entry["cost"] = name_of(cost);
    entry["found"] = bool(found);
    if (found) {
      ways.push_back({cost, *found, totals_of(*found, cells, costs)});
      add_forecast(request.map, grid, cells, costs, soils, ways.back());
      for (const auto& [key, value] : ways.back().totals.members()) entry[key] = value;
      entry["corners"] = std::uint64_t(found->cell.size());
      if (request.turning > 0) {
        entry["turned_degrees"] = Turning(cells, costs.at(cost), request.turning).turns(found->cell).degrees;
        entry["turning_m"] = entry.at("turned_degrees").number() / 90 * request.turning;
      }
    }
    routes.push_back(entry);
  }
  return routes;
}

}  // namespace gonogo::map
