#include "pipeline/map/route/plan_route.h"

#include "base/error.h"
#include "base/line.h"
#include "pipeline/map/route/find_ways.h"
#include "pipeline/map/route/map_cells.h"
#include "pipeline/map/route/reach_files.h"
#include "pipeline/map/route/robot_files.h"
#include "pipeline/map/route/search.h"
#include "pipeline/map/route/write_ways.h"
#include "pipeline/map/write/map_record.h"
#include "terrain/raster/polygon_cells.h"

namespace gonogo::map {
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

}  // namespace

Json plan_route(const RouteRequest& request) {
  require_places(request);
  const MapRequest& map = request.map;
  const MapSources sources = open_sources(map.region);
  const terrain::MapGrid& grid = sources.elevation.grid();
  const Region occurring = with_occurring_soils(map.region, sources);
  SoilTable table = make_soil_table(without_spread(map.model), occurring, map.rules, 0);
  add_ditches(without_spread(map.model), occurring, map.rules, 0, sources, table);
  const AllCosts costs = all_costs(table, request.costs, map.rules.correlation_length);
  RouteCells cells = read_route_cells(sources, map.region, table, map.rules, map.threads);
  avoid(request.avoid, grid, cells);
  Json result = Json::object(), files = Json::array();
  result["crs"] = grid.crs_code.empty() ? grid.crs_name : grid.crs_code;
  result["cells"] = std::uint64_t(cells.soil.size());
  result["directions"] = request.eight_directions ? "eight" : "any";
  std::vector<FoundWay> ways;
  result["routes"] = request.to ? find_ways(request, grid, table, cells, costs, ways) : Json::array();
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
