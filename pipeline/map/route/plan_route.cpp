#include "pipeline/map/route/plan_route.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/map/route/any_angle.h"
#include "pipeline/map/route/drive_of_way.h"
#include "pipeline/map/route/map_cells.h"
#include "pipeline/map/route/reach_files.h"
#include "pipeline/map/route/robot_files.h"
#include "pipeline/map/route/search.h"
#include "pipeline/map/route/track.h"
#include "pipeline/map/route/turning.h"
#include "pipeline/map/write/map_record.h"
#include "terrain/raster/gpx.h"
#include "terrain/raster/polygon_cells.h"
#include "terrain/raster/vector.h"

namespace gonogo::map {
namespace {

std::uint32_t cell_at(const Place& place, const terrain::MapGrid& grid, const RouteCells& cells, const char* which) {
  const double column = std::floor((place.x - grid.west) / grid.cell_width);
  const double row = std::floor((grid.north - place.y) / grid.cell_height);
  if (!(column >= 0 && column < grid.columns && row >= 0 && row < grid.rows))
    throw InputError(
        line("route: %s %.10g,%.10g lies outside the elevation raster, which covers %.10g to %.10g and "
             "%.10g to %.10g; give coordinates in its system",
             which, place.x, place.y, grid.west, grid.west + grid.columns * grid.cell_width,
             grid.north - grid.rows * grid.cell_height, grid.north));
  const auto cell = std::uint32_t(row) * std::uint32_t(grid.columns) + std::uint32_t(column);
  if (!cells.is_open(cell))
    throw InputError(
        line("route: %s %.10g,%.10g has no elevation or no known soil, or is closed by land cover or a polygon to "
             "avoid; choose "
             "a place next to it",
             which, place.x, place.y));
  return cell;
}

/// Cost of a way by another measure than the one it was found with.
double cost_along(const FoundRoute& route, const RouteCells& cells, const RouteCosts& costs) {
  double sum = 0;
  for (std::size_t i = 1; i < route.cell.size(); ++i) sum += line_cost(cells, costs, route.cell[i - 1], route.cell[i]);
  return sum;
}

/// Every cost that the model tells.
using AllCosts = std::map<RouteCost, RouteCosts>;

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

Json totals_of(const FoundRoute& route, const RouteCells& cells, const AllCosts& costs) {
  const auto total = [&](RouteCost cost) { return cost_along(route, cells, costs.at(cost)); };
  Json json = Json::object();
  json["length_m"] = total(RouteCost::length);
  json["risk"] = total(RouteCost::risk);
  if (costs.count(RouteCost::time)) json["time_s"] = total(RouteCost::time);
  if (costs.count(RouteCost::energy)) json["energy_j"] = total(RouteCost::energy);
  return json;
}

constexpr double kMostTurning = 10000;  // [m]
constexpr const char* kWeakColour = "#ff7f0e";
/// Colours of the lines, in the order of RouteCost: told apart without red and green, and none is a class's.
constexpr std::array<const char*, 4> kLineColours = {"#1a1a1a", "#c2188f", "#1f4fbf", "#6b3fa0"};

/// What a route asks of a model: neither how new a cell is to it, nor how far its members disagree.
OutcomeModel without_spread(OutcomeModel model) {
  model.novelty = nullptr;
  model.members.clear();
  return model;
}

/// Which places are needed for what is asked.
void require_places(const RouteRequest& request) {
  if (!(request.turning >= 0 && request.turning <= kMostTurning))
    throw InputError(
        line("route: --turning: %g m is outside 0 to %g m; give the metres of driving that cost as much as "
             "a turn by 90 degrees",
             request.turning, kMostTurning));
  if (request.turning > 0 && request.eight_directions)
    throw InputError("route: --turning: ways in eight directions do not count turns; leave out --eight-directions");
  if (request.turning > 0 && !request.to)
    throw InputError("route: --turning: only a way has turns; give --from and --to");
  const bool spread = !request.reach.empty() || !request.isochrones.empty();
  if (!request.from && (request.to || !request.lines.empty() || spread))
    throw InputError("route: --from is missing: the place to start from, easting,northing");
  if (!request.to && !request.lines.empty())
    throw InputError("route: --to is missing: the end of the lines in --out, easting,northing");
  if (!request.to && !request.via.empty())
    throw InputError("route: --to is missing: the end of the way over --via, easting,northing");
  const bool for_robots = !request.costmap.empty() || !request.grid_map.empty();
  if (!request.to && !spread && !for_robots && request.regions.empty())
    throw InputError(
        "route: nothing is asked for; give --from and --to for a way, --from with --reach or --isochrones for what can "
        "be reached, --regions for the connected regions, or --costmap or --grid-map for a robot");
}

/// The places to pass, as cells.
std::vector<std::uint32_t> stops_of(const RouteRequest& request, const terrain::MapGrid& grid,
                                    const RouteCells& cells) {
  std::vector<std::uint32_t> stops = {cell_at(*request.from, grid, cells, "--from")};
  for (const Place& place : request.via) stops.push_back(cell_at(place, grid, cells, "--via"));
  stops.push_back(cell_at(*request.to, grid, cells, "--to"));
  return stops;
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

/// A way that was found.
struct Found {
  RouteCost cost;
  FoundRoute route;
  Json totals;                                   // and the forecast of the drive
  std::vector<std::array<double, 2>> weakest{};  // the weakest stretch, in the grid's coordinate system; may be empty
};

/// Adds the chance to get through, the places where one gets stuck, and the weakest stretch.
void add_forecast(const MapRequest& map, const terrain::MapGrid& grid, const RouteCells& cells, const AllCosts& costs,
                  const std::vector<DriveSoil>& soils, Found& found) {
  const auto pieces = pieces_of(found.route, cells, costs.at(RouteCost::length));
  const DriveForecast forecast =
      forecast_drive(pieces, soils, map.model, drive_doubt(map.region.elevation, map.rules, grid));
  const Json json = forecast_json(forecast, pieces, soils);
  for (const auto& [key, value] : json.members()) found.totals[key] = value;
  if (forecast.weakest) found.weakest = line_over(found.route, grid, forecast.weakest->first, forecast.weakest->last);
}

/// The cheapest way by each cost asked for: what it costs, and its line where one was found.
Json find_routes(const RouteRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                 const RouteCells& cells, const AllCosts& costs, std::vector<Found>& ways) {
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

/// Tracks with heights, and with times if the model tells them.
void write_tracks(const RouteRequest& request, const MapSources& sources, const RouteCells& cells,
                  const AllCosts& costs, const std::vector<Found>& ways) {
  const terrain::MapGrid& grid = sources.elevation.grid();
  const auto time = costs.find(RouteCost::time);
  const TrackTolerance most{.distance = 0.25 * std::min(grid.cell_width, grid.cell_height)};
  std::vector<terrain::Track> tracks;
  for (const Found& way : ways)
    tracks.push_back(
        {name_of(way.cost),
         simplified(track_of(way.route, cells, time == costs.end() ? nullptr : &time->second, sources.elevation),
                    most)});
  std::vector<terrain::Stop> stops;
  const std::vector<std::uint32_t> places = stops_of(request, grid, cells);
  for (std::size_t i = 0; i < places.size(); ++i) {
    terrain::TrackPoint at = centre_of(places[i], grid);
    at.height = height_at(sources.elevation, at.x, at.y);
    stops.push_back({i == 0 ? "start" : i + 1 == places.size() ? "end" : line("waypoint %zu", i), at});
  }
  for (const Found& way : ways)
    if (const Json* weakest = way.totals.find("weakest"))
      stops.push_back({name_of(way.cost) + ", weakest stretch, " + weakest_text(*weakest),
                       {.x = way.weakest.front()[0], .y = way.weakest.front()[1]}});
  terrain::write_gpx(request.lines, grid, stops, tracks, request.departure);
}

/// The ways and their weakest stretches.
std::vector<terrain::LineFeature> lines_of(const std::vector<Found>& ways, const terrain::MapGrid& grid) {
  std::vector<terrain::LineFeature> lines;
  for (const Found& way : ways) {
    terrain::LineFeature line{
        .name = name_of(way.cost), .colour = kLineColours[std::size_t(way.cost)], .point = {}, .attribute = {}};
    for (const std::uint32_t cell : way.route.cell) {
      const terrain::TrackPoint at = centre_of(cell, grid);
      line.point.push_back({at.x, at.y});
    }
    for (const auto& [key, value] : way.totals.members())
      if (value.is_number()) line.attribute.emplace_back(key, value.number());
    lines.push_back(std::move(line));
  }
  for (const Found& way : ways)
    if (const Json* weakest = way.totals.find("weakest"))
      lines.push_back({.name = name_of(way.cost) + ", weakest stretch, " + weakest_text(*weakest),
                       .colour = kWeakColour,
                       .point = way.weakest,
                       .attribute = {}});
  return lines;
}

void write_ways(const RouteRequest& request, const MapSources& sources, const RouteCells& cells, const AllCosts& costs,
                const std::vector<Found>& ways) {
  if (request.lines.extension() == ".gpx")
    write_tracks(request, sources, cells, costs, ways);
  else
    terrain::write_lines(request.lines, sources.elevation.grid(), "routes", lines_of(ways, sources.elevation.grid()));
}

/// Closes the cells that a polygon touches.
void avoid(const std::filesystem::path& polygons, const terrain::MapGrid& grid, RouteCells& cells) {
  if (polygons.empty()) return;
  const std::vector<std::uint8_t> under = terrain::cells_under(polygons, grid);
  for (std::size_t c = 0; c < under.size(); ++c)
    if (under[c] && cells.soil[c] != RouteCells::kNowhere) cells.soil[c] = RouteCells::kClosed;
}

void write_spread(const RouteRequest& request, const terrain::MapGrid& grid, const RouteCells& cells,
                  const RouteCosts& costs) {
  const RouteCost cost = request.costs.front();
  const std::uint32_t start = cell_at(*request.from, grid, cells, "--from");
  const std::vector<float> least =
      request.eight_directions ? reach(cells, costs, start) : reach_any_angle(cells, costs, start);
  if (!request.reach.empty())
    write_reach(request.reach, grid, cost, least, map_metadata(request.map, map_inputs(request.map)),
                request.map.threads);
  if (!request.isochrones.empty()) write_isochrones(request.isochrones, grid, cost, least, request.interval);
}

}  // namespace

Json plan_route(const RouteRequest& request) {
  require_places(request);
  const MapRequest& map = request.map;
  const MapSources sources = open_sources(map.region);
  const terrain::MapGrid& grid = sources.elevation.grid();
  const SoilTable table =
      make_soil_table(without_spread(map.model), with_occurring_soils(map.region, sources), map.rules, 0);
  const AllCosts costs = all_costs(table, request.costs, map.rules.correlation_length);
  RouteCells cells = read_route_cells(sources, map.region, table, map.rules, map.threads);
  avoid(request.avoid, grid, cells);
  Json result = Json::object(), files = Json::array();
  result["crs"] = grid.crs_code.empty() ? grid.crs_name : grid.crs_code;
  result["cells"] = std::uint64_t(cells.soil.size());
  result["directions"] = request.eight_directions ? "eight" : "any";
  std::vector<Found> ways;
  result["routes"] = request.to ? find_routes(request, grid, table, cells, costs, ways) : Json::array();
  if (!request.lines.empty() && !ways.empty()) {
    write_ways(request, sources, cells, costs, ways);
    files.push_back(request.lines.string());
  }
  if (!request.reach.empty() || !request.isochrones.empty())
    write_spread(request, grid, cells, costs.at(request.costs.front()));
  if (!request.regions.empty())
    result["regions"] = write_regions(request.regions, grid, connected_regions(cells, costs.at(RouteCost::length)));
  if (!request.costmap.empty()) {
    write_costmap(request.costmap, grid, table, cells, costs.at(request.costs.front()), request.costs.front());
    files.push_back(std::filesystem::path(request.costmap).replace_extension(".pgm").string());
  }
  if (!request.grid_map.empty())
    write_grid_map(request.grid_map, sources.elevation, table, cells, costs.at(request.costs.front()),
                   request.costs.front());
  for (const auto& file : {request.reach, request.isochrones, request.regions, request.costmap, request.grid_map})
    if (!file.empty()) files.push_back(file.string());
  result["files"] = files;
  return result;
}

}  // namespace gonogo::map
