#include "pipeline/map/route/plan_route.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/map/route/any_angle.h"
#include "pipeline/map/route/map_cells.h"
#include "pipeline/map/route/reach_files.h"
#include "pipeline/map/route/robot_files.h"
#include "pipeline/map/route/search.h"
#include "pipeline/map/route/track.h"
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
  json["chance"] = std::exp(-total(RouteCost::risk));
  if (costs.count(RouteCost::time)) json["time_s"] = total(RouteCost::time);
  if (costs.count(RouteCost::energy)) json["energy_j"] = total(RouteCost::energy);
  return json;
}

/// Colours of the lines, in the order of RouteCost: told apart without red and green, and none is a class's.
constexpr std::array<const char*, 4> kLineColours = {"#1a1a1a", "#c2188f", "#1f4fbf", "#6b3fa0"};

terrain::LineFeature line_of(const FoundRoute& route, const terrain::MapGrid& grid, const Json& totals,
                             RouteCost cost) {
  terrain::LineFeature line;
  line.name = name_of(cost);
  line.colour = kLineColours[std::size_t(cost)];
  for (const std::uint32_t cell : route.cell) {
    const terrain::TrackPoint at = centre_of(cell, grid);
    line.point.push_back({at.x, at.y});
  }
  for (const auto& [key, value] : totals.members()) line.attribute.emplace_back(key, value.number());
  return line;
}

/// What a route asks of a model: neither how new a cell is to it, nor how far its members disagree.
OutcomeModel without_spread(OutcomeModel model) {
  model.novelty = nullptr;
  model.members.clear();
  return model;
}

/// Which places are needed for what is asked.
void require_places(const RouteRequest& request) {
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
};

/// The cheapest way by each cost asked for: what it costs, and its line where one was found.
Json find_routes(const RouteRequest& request, const terrain::MapGrid& grid, const RouteCells& cells,
                 const AllCosts& costs, std::vector<terrain::LineFeature>& lines, std::vector<Found>& ways) {
  const std::vector<std::uint32_t> stops = stops_of(request, grid, cells);
  Json routes = Json::array();
  for (const RouteCost cost : request.costs) {
    const auto found = way_over(stops, request, cells, costs.at(cost));
    Json entry = Json::object();
    entry["cost"] = name_of(cost);
    entry["found"] = bool(found);
    if (found) {
      const Json sums = totals_of(*found, cells, costs);
      for (const auto& [key, value] : sums.members()) entry[key] = value;
      entry["corners"] = std::uint64_t(found->cell.size());
      lines.push_back(line_of(*found, grid, sums, cost));
      ways.push_back({cost, *found});
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
  terrain::write_gpx(request.lines, grid, stops, tracks, request.departure);
}

void write_ways(const RouteRequest& request, const MapSources& sources, const RouteCells& cells, const AllCosts& costs,
                const std::vector<terrain::LineFeature>& lines, const std::vector<Found>& ways) {
  if (request.lines.extension() == ".gpx")
    write_tracks(request, sources, cells, costs, ways);
  else
    terrain::write_lines(request.lines, sources.elevation.grid(), "routes", lines);
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

Place parse_place(const std::string& text, const std::string& where) {
  Place place;
  const std::size_t comma = text.find(',');
  const auto number = [&](std::size_t from, std::size_t to, double& value) {
    const auto [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
    return error == std::errc() && end == text.data() + to && std::isfinite(value);
  };
  if (comma == std::string::npos || !number(0, comma, place.x) || !number(comma + 1, text.size(), place.y))
    throw InputError(where + ": \"" + text + "\" is no place; give easting,northing in the region's coordinate system");
  return place;
}

std::int64_t parse_departure(const std::string& text, const std::string& where) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0, used = 0;
  const bool read = std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d:%2dZ%n", &year, &month, &day, &hour, &minute,
                                &second, &used) == 6 &&
                    used == int(text.size()) && text.size() == 20;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(unsigned(month)),
                                         std::chrono::day(unsigned(day))};
  if (!read || !date.ok() || hour > 23 || minute > 59 || second > 59)
    throw InputError(where + ": \"" + text + "\" is no time; give it as in 2026-05-01T06:00:00Z");
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return std::int64_t(days) * 86400 + hour * 3600 + minute * 60 + second;
}

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
  std::vector<terrain::LineFeature> lines;
  std::vector<Found> ways;
  result["routes"] = request.to ? find_routes(request, grid, cells, costs, lines, ways) : Json::array();
  if (!request.lines.empty() && !lines.empty()) {
    write_ways(request, sources, cells, costs, lines, ways);
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

std::string route_text(const Json& result) {
  std::string text;
  for (const Json& route : result.at("routes").items()) {
    const std::string& cost = route.at("cost").string();
    if (!route.at("found").boolean()) {
      text += line("%-13s no way is known: every path crosses cells that are no-go or unknown in its direction\n",
                   cost.c_str());
      continue;
    }
    text += line("%-13s %8.3f km, chance to get through %.3f", cost.c_str(), route.at("length_m").number() / 1000,
                 route.at("chance").number());
    if (const Json* time = route.find("time_s")) text += line(", %.0f s", time->number());
    if (const Json* energy = route.find("energy_j")) text += line(", %.3f MJ of drive energy", energy->number() / 1e6);
    text += "\n";
  }
  if (const Json* regions = result.find("regions"))
    text +=
        line("%.0f connected regions; the largest holds %.4g of %.4g km2 that some heading passes\n",
             regions->at("count").number(), regions->at("largest_km2").number(), regions->at("passable_km2").number());
  for (const Json& file : result.at("files").items()) text += file.string() + "\n";
  return text;
}

}  // namespace gonogo::map
