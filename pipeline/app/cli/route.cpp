#include <memory>

#include "pipeline/app/cli/map_options.h"
#include "pipeline/map/route/plan_route.h"

namespace gonogo::app {
namespace {

struct Options {
  map::MapFiles files;
  std::string from, to, out, reach, isochrones, regions;
  double interval = 0;
  std::vector<std::string> costs;
};

void route(const Options& options, const Globals& globals) {
  map::RouteRequest request;
  if (!options.from.empty()) request.from = map::parse_place(options.from, "route: --from");
  if (!options.to.empty()) request.to = map::parse_place(options.to, "route: --to");
  for (const std::string& name : options.costs) request.costs.push_back(map::route_cost_named(name));
  request.lines = options.out;
  request.reach = options.reach;
  request.isochrones = options.isochrones;
  request.interval = options.interval;
  request.regions = options.regions;
  request.map = map_request_of(options.files, globals);
  const Json result = map::plan_route(request);
  print_result(globals, result, map::route_text(result));
}

}  // namespace

void add_route_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand(
      "route", "Ways over a region: fastest, safest, of least energy, shortest; what can be reached");
  auto options = std::make_shared<Options>();
  add_map_file_options(*command, options->files);
  command->add_option("--from", options->from, "Start: easting,northing in the region's coordinate system");
  command->add_option("--to", options->to, "End, likewise");
  command->add_option("--cost", options->costs, "fastest, safest, least-energy or shortest; several give several lines")
      ->default_val(std::vector<std::string>{"safest"})
      ->delimiter(',');
  command->add_option("--out", options->out, "Lines: .gpkg, .geojson or .gpx");
  command->add_option("--reach", options->reach, "GeoTIFF of the least cost from the start to every cell");
  command->add_option("--isochrones", options->isochrones,
                      "GeoPackage: polygons of what is reached from the start within bands of the first cost");
  command->add_option("--interval", options->interval,
                      "Width of these bands: s, m, J, or for the safest -ln of the chance; by default a round one");
  command->add_option("--regions", options->regions,
                      "GeoPackage: connected regions, inside of which every place can be reached from every other");
  command->footer(
      "Costs and what a route may cross: docs/map.md.\n\nExample:\n"
      "  gonogo route --model out/demo/model.h5 --dataset out/demo/dataset.h5 --region configs/regions/sagehen.json\n"
      "      --from 216000,4368000 --to 221000,4372500 --cost fastest,safest --out routes.gpkg --isochrones "
      "minutes.gpkg");
  command->callback([options, &globals] { route(*options, globals); });
}

}  // namespace gonogo::app
