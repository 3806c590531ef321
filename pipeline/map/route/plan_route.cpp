#include "pipeline/map/route/plan_route.h"

#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "pipeline/map/route/find_ways.h"
#include "pipeline/map/route/reach.h"
#include "pipeline/map/route/robot_files.h"
#include "pipeline/map/route/way_files.h"
#include "terrain/raster/vector/read_vector.h"

namespace gonogo::map {

namespace {

void take(const TileLayers& tile, const std::vector<LandRule>& land, RouteCells& cells) {
  for (int row = 0; row < tile.window.rows; ++row)
    for (int column = 0; column < tile.window.columns; ++column) {
      const float slope = tile.slope.at(column, row), aspect = tile.aspect.at(column, row);
      const CellMark& mark = tile.mark[std::size_t(row) * std::size_t(tile.window.columns) + std::size_t(column)];
      const std::size_t i = std::size_t(tile.window.row + row) * std::size_t(cells.columns) + std::size_t(column);
      if (mark.has_rule() && land[mark.rule].verdict == campaign::Verdict::no_go) cells.soil[i] = RouteCells::kClosed;
      if (!mark.has_soil() || mark.has_rule()) continue;
      cells.slope[i] = std::uint16_t(std::lround(slope * kSlopeSteps));
      cells.aspect[i] = std::isnan(aspect) ? 0 : std::uint16_t(rounded_aspect(aspect));
      cells.soil[i] = std::uint8_t(mark.soil);
    }
}

}  // namespace

RouteCells read_route_cells(const MapSources& sources, const Region& region, const SoilTable& table,
                            const MapRules& rules, int threads) {
  const terrain::MapGrid& grid = sources.elevation.grid();
  if (table.soils.size() >= RouteCells::kClosed)
    throw InputError("route: the region lists " + std::to_string(table.soils.size()) +
                     " soils; at most 253 can be used");
  RouteCells cells;
  cells.columns = grid.columns;
  cells.rows = grid.rows;
  cells.cell_width = grid.cell_width_m();
  cells.cell_height = grid.cell_height_m();
  const std::size_t count = std::size_t(grid.columns) * std::size_t(grid.rows);
  cells.slope.assign(count, 0);
  cells.aspect.assign(count, 0);
  cells.soil.assign(count, RouteCells::kNowhere);
  const std::vector<terrain::Window> bands = windows_of(grid, grid.columns, 128);
  const std::vector<LandRule> land = land_rules(region);
  for_each_with_own(
      bands.size(), 1, [&] { return sources.again(); },
      [&](MapSources& own, std::size_t band) {
        take(evaluate_tile(own, region, table, {}, rules, bands[band]), land, cells);
      },
      threads);
  return cells;
}

namespace {

constexpr double kMostTurning = 10000;  // [m]

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

Json weakest_json(const StuckStretch& stretch) {
  return Json::Object{{"from_km", stretch.begin / 1000},
                      {"to_km", stretch.end / 1000},
                      {"stuck", stretch.stuck},
                      {"reason", stretch.reason},
                      {"soil", stretch.soil},
                      {"slope_along_deg", stretch.slope_along},
                      {"slope_across_deg", stretch.slope_across}};
}

}  // namespace

RouteResult plan_route(const RouteRequest& request) {
  require_places(request);
  const MapRequest& map = request.map;
  const MapSources sources = open_sources(map.region);
  const terrain::MapGrid& grid = sources.elevation.grid();
  const SoilTable table = make_soil_table(without_spread(map.model), map.region, map.rules, 0, sources);
  const AllCosts costs = all_costs(table, request.costs, map.rules.correlation_length);
  RouteCells cells = read_route_cells(sources, map.region, table, map.rules, map.threads);
  avoid(request.avoid, grid, cells);
  RouteResult result{.crs = grid.crs_code.empty() ? grid.crs_name : grid.crs_code,
                     .cells = cells.soil.size(),
                     .eight_directions = request.eight_directions,
                     .ways = {},
                     .dead_end = {},
                     .regions = {},
                     .files = {}};
  if (request.to) result.ways = find_ways(request, grid, table, cells, costs);
  if (std::any_of(result.ways.begin(), result.ways.end(), [](const auto& way) { return !way.second; }))
    result.dead_end = find_dead_end(request, grid, table, cells, costs.begin()->second);
  std::vector<FoundWay> found;
  for (const auto& [cost, way] : result.ways)
    if (way) found.push_back(*way);
  if (!request.lines.empty() && !found.empty()) {
    write_ways(request, sources, cells, costs, found);
    result.files.push_back(request.lines);
  }
  if (!request.reach.empty() || !request.isochrones.empty())
    write_spread(request, grid, cells, costs.at(request.costs.front()));
  if (!request.regions.empty())
    result.regions = write_regions(request.regions, grid, connected_regions(cells, costs.at(RouteCost::length)));
  if (!request.costmap.empty()) {
    write_costmap(request.costmap, grid, table, cells, costs.at(request.costs.front()), request.costs.front());
    result.files.push_back(std::filesystem::path(request.costmap).replace_extension(".pgm"));
  }
  if (!request.grid_map.empty())
    write_grid_map(request.grid_map, sources.elevation, table, cells, costs.at(request.costs.front()),
                   request.costs.front());
  for (const auto& file : {request.reach, request.isochrones, request.regions, request.costmap, request.grid_map})
    if (!file.empty()) result.files.push_back(file);
  return result;
}

Place parse_place(const std::string& text, const std::string& where) {
  const std::size_t comma = text.find(',');
  const auto x = parsed<double>(text.substr(0, comma));
  const auto y = comma == std::string::npos ? std::nullopt : parsed<double>(text.substr(comma + 1));
  if (!x || !y || !std::isfinite(*x) || !std::isfinite(*y))
    throw InputError(where + ": \"" + text + "\" is no place; give easting,northing in the region's coordinate system");
  return {*x, *y};
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

std::vector<std::pair<std::string, double>> numbers_of(const FoundWay& way) {
  std::vector<std::pair<std::string, double>> numbers = {{"length_m", way.length}, {"risk", way.risk}};
  if (way.time) numbers.emplace_back("time_s", *way.time);
  if (way.energy) numbers.emplace_back("energy_j", *way.energy);
  numbers.insert(numbers.end(), {{"chance", way.passage.chance},
                                 {"chance_error", way.passage.error},
                                 {"stuck_places", way.passage.places},
                                 {"not_sampled", way.passage.not_sampled}});
  return numbers;
}

std::string weakest_text(const StuckStretch& s) {
  return line("km %.2f to %.2f: %s in %.1f %% of the draws, %s, slope %.0f degrees along and %.0f across",
              s.begin / 1000, s.end / 1000, s.reason.c_str(), 100 * s.stuck, s.soil.c_str(), s.slope_along,
              s.slope_across);
}

Json route_json(const RouteResult& result) {
  Json json = Json::object(), routes = Json::array(), files = Json::array();
  json["crs"] = result.crs;
  json["cells"] = result.cells;
  json["directions"] = result.eight_directions ? "eight" : "any";
  for (const auto& [cost, way] : result.ways) {
    Json entry = Json::Object{{"cost", name_of(cost)}, {"found", bool(way)}};
    if (way) {
      for (const auto& [name, value] : numbers_of(*way)) entry[name] = value;
      if (way->passage.weakest) entry["weakest"] = weakest_json(*way->passage.weakest);
      entry["corners"] = std::uint64_t(way->route.cell.size());
      if (way->turned) {
        entry["turned_degrees"] = *way->turned;
        entry["turning_m"] = way->turning;
      }
    }
    routes.push_back(entry);
  }
  json["routes"] = routes;
  if (const auto& end = result.dead_end)
    json["dead_end"] = Json::Object{
        {"place", Json::Array{end->place.x, end->place.y}}, {"short_of_m", end->short_of}, {"by", end->by}};
  if (const auto& regions = result.regions)
    json["regions"] =
        Json::Object{{"count", regions->count}, {"largest_km2", regions->largest}, {"passable_km2", regions->passable}};
  for (const auto& file : result.files) files.push_back(file.string());
  json["files"] = files;
  return json;
}

std::string dead_end_text(const DeadEnd& end) {
  return line("the nearest place that can be reached is %.10g,%.10g, %.0f m short; beyond it lies ", end.place.x,
              end.place.y, end.short_of) +
         end.by;
}

std::string route_text(const RouteResult& result) {
  std::string text;
  for (const auto& [cost, way] : result.ways) {
    const std::string name = name_of(cost);
    if (!way) {
      text += line("%-13s no way is known: every path crosses cells that are no-go or unknown in its direction\n",
                   name.c_str());
      continue;
    }
    text += line("%-13s %8.3f km, chance to get through %.2f", name.c_str(), way->length / 1000, way->passage.chance);
    if (way->time) text += line(", %.0f s", *way->time);
    if (way->energy) text += line(", %.3f MJ of drive energy", *way->energy / 1e6);
    text += line(", stuck at %.2g places\n", way->passage.places);
    if (way->turned)
      text += line("              turns by %.0f degrees in all, which count as %.0f m\n", *way->turned, way->turning);
    if (way->passage.weakest) text += "              weakest " + weakest_text(*way->passage.weakest) + "\n";
    if (way->passage.not_sampled > 0)
      text += line("              with a chance of %.2f some soil on it is unlike all that was simulated\n",
                   way->passage.not_sampled);
  }
  if (result.regions)
    text += line("%.0f connected regions; the largest holds %.4g of %.4g km2 that some heading passes\n",
                 double(result.regions->count), result.regions->largest, result.regions->passable);
  for (const auto& file : result.files) text += file.string() + "\n";
  return text;
}

}  // namespace gonogo::map
