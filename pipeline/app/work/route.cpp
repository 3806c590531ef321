#include "pipeline/app/work/map_request.h"
#include "pipeline/app/work/work.h"
#include "pipeline/map/route/plan_route.h"

namespace gonogo::app {

void route_work(const Globals& globals, const RouteOptions& options) {
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
  const Json result = map::plan_route(request);
  print_result(globals, result, map::route_text(result));
}

}  // namespace gonogo::app
