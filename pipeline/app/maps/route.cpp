#include <memory>

#include "pipeline/app/cli/work.h"
#include "pipeline/app/maps/map_options.h"
#include "pipeline/map/route/plan_route.h"

namespace gonogo::app {
namespace {

struct RouteOptions {
  map::MapFiles files;
  std::string from, to;          // "easting,northing"; empty: not asked
  std::vector<std::string> via;  // places between
  std::string avoid, departure;  // polygons; time of GPX tracks, empty: kNoDate
  bool eight_directions = false;
  double turning = 0;                           // metres that cost as much as a turn by 90 degrees
  std::string costmap, grid_map;                // files; empty: not written
  std::vector<std::string> costs{"safest"};     // names; the first one also bands and reaches
  std::string out, reach, isochrones, regions;  // files; empty: not written
  double interval = 0;                          // width of a band, in the unit of the first cost; 0: a round one
};

void find_routes(const Globals& globals, const RouteOptions& options) {
  map::RouteRequest request;
  if (!options.from.empty()) request.from = map::parse_place(options.from, "route: --from");
  if (!options.to.empty()) request.to = map::parse_place(options.to, "route: --to");
  for (const std::string& place : options.via) request.via.push_back(map::parse_place(place, "route: --via"));
  request.avoid = options.avoid;
  request.eight_directions = options.eight_directions;
  request.turning = options.turning;
  if (!options.departure.empty()) request.departure = map::parse_departure(options.departure, "route: --departure");
  request.costmap = options.costmap;
  request.grid_map = options.grid_map;
  for (const std::string& name : options.costs) request.costs.push_back(map::route_cost_named(name));
  request.lines = options.out;
  request.reach = options.reach;
  request.isochrones = options.isochrones;
  request.interval = options.interval;
  request.regions = options.regions;
  request.map = map_request_of(globals, options.files);
  const map::RouteResult result = map::plan_route(request);
  const bool all = std::all_of(result.ways.begin(), result.ways.end(), [](const auto& way) { return way.second; });
  if (all) return print_result(globals, map::route_json(result), map::route_text(result));
  fail_with_result(globals, map::route_json(result), map::route_text(result),
                   DeviceError("route: no way leads there" +
                               (result.dead_end ? "; " + dead_end_text(*result.dead_end) : std::string())));
}

}  // namespace

void add_route_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand(
      "route", "Ways over a region: fastest, safest, of least energy, shortest; what can be reached");
  const auto options = std::make_shared<RouteOptions>();
  add_map_file_options(*command, options->files);
  add_named(*command, "--from", options->from, "E,N", "Start: easting,northing in the region's coordinate system");
  add_named(*command, "--to", options->to, "E,N", "End, likewise");
  add_named(*command, "--via", options->via, "E,N", "Places to pass between, in this order");
  add_named(*command, "--avoid", options->avoid, kFile,
            "Polygons that no way may touch: GeoJSON, GeoPackage or another format of GDAL");
  command->add_flag("--eight-directions", options->eight_directions,
                    "Steps to the eight neighbours only, as the page takes; quicker, up to 8 % longer");
  add_named(*command, "--turning", options->turning, "NUMBER",
            "A turn by 90 degrees costs as much as driving so many metres there; 0: turns cost nothing [m]")
      ->capture_default_str();
  add_named(*command, "--cost", options->costs, one_of({"fastest", "safest", "least-energy", "shortest"}),
            "What a way has least of; several give several lines")
      ->delimiter(',')
      ->capture_default_str();
  add_named(*command, "--out", options->out, kFile, "Lines: .gpkg, .geojson, or .gpx with elevation and time");
  add_named(*command, "--departure", options->departure, "TIME",
            "When the track of a .gpx starts, such as 2026-05-01T06:00:00Z; by default the first second of 2000");
  add_named(*command, "--reach", options->reach, kFile, "GeoTIFF of the least cost from the start to every cell");
  add_named(*command, "--isochrones", options->isochrones, kFile,
            "GeoPackage: polygons of what is reached from the start within bands of the first cost");
  command->add_option("--interval", options->interval,
                      "Width of these bands: s, m, J, or for the safest -ln of the chance; by default a round one");
  add_named(*command, "--regions", options->regions, kFile,
            "GeoPackage: connected regions, inside of which every place can be reached from every other");
  add_named(*command, "--costmap", options->costmap, kFile,
            "Costmap for Nav2 by the first cost: .yaml, and a .pgm beside it; docs/map.md says what values mean");
  add_named(*command, "--grid-map", options->grid_map, kFile,
            "Layers for grid_map, .nc or .tif: elevation, and by heading the first cost and what passes");
  add_examples(*command,
               {"gonogo route --model out/demo/model.h5 \\\n"
                "      --region configs/regions/sagehen.json --from 216000,4368000 --to 221000,4372500 \\\n"
                "      --cost fastest,safest --out routes.gpkg --isochrones minutes.gpkg"},
               "Costs and what a route may cross: docs/map.md.");
  calls<find_routes>(*command, globals, options);
}

}  // namespace gonogo::app
