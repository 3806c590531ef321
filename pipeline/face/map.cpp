#include <gonogo/map.h>

#include "base/files/shipped.h"
#include "base/format.h"
#include "pipeline/face/inside.h"
#include "pipeline/map/map_request.h"
#include "pipeline/map/route/plan_route.h"
#include "pipeline/map/write/compare_maps.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::api {
namespace {

map::MapRequest request_of(const MapRequest& r) {
  map::MapFiles files;
  files.model = r.model;
  files.region = r.region;
  files.dem = r.dem;
  files.soil = r.soil;
  files.cone_index = r.cone_index;
  files.members = r.members;
  if (!r.study.empty()) files.study = shipped_file("studies", "study", r.study);
  if (!r.vehicle.empty()) files.vehicle = shipped_file("vehicles", "vehicle", r.vehicle);
  files.moisture = r.moisture;
  for (const auto& [name, value] : r.mission) files.set.push_back(name + "=" + line("%.17g", value));
  files.heading = r.heading;
  files.max_speed_km_h = r.max_speed_km_h;
  files.out = r.out;
  files.colour_blind_safe = r.colour_blind_safe;
  files.threads = r.threads;
  return map::read_map_request(files);
}

map::Place place_of(const Place& p) { return {p.x, p.y}; }

Route route_of(map::RouteCost cost, const std::optional<map::FoundWay>& way) {
  Route route;
  route.cost = map::name_of(cost);
  route.found = bool(way);
  if (!way) return route;
  route.length = way->length;
  route.time = way->time;
  route.energy = way->energy;
  route.chance = way->passage.chance;
  route.chance_error = way->passage.error;
  if (way->passage.weakest) route.weakest = map::weakest_text(*way->passage.weakest);
  return route;
}

std::vector<CellClass> classes_of(const std::vector<map::ComparedClass>& classes) {
  std::vector<CellClass> result;
  for (const map::ComparedClass& c : classes) result.push_back({c.label, c.area, c.share});
  return result;
}

}  // namespace

MapSummary make_map(const MapRequest& request) {
  return guarded([&] {
    const map::MapSummary made = map::make_map(request_of(request));
    MapSummary result{.area_km2 = made.area_km2, .files = made.files, .remarks = made.remarks, .reused = made.reused};
    for (const Verdict verdict : {Verdict::go, Verdict::slow_go, Verdict::no_go, Verdict::unknown})
      result.share[verdict] = made.area.share(campaign::Verdict(int(verdict)));
    return result;
  });
}

std::vector<Route> plan_routes(const RouteRequest& request) {
  return guarded([&] {
    map::RouteRequest asked;
    asked.map = request_of(request.map);
    asked.from = place_of(request.start);
    asked.to = place_of(request.end);
    for (const Place& p : request.via) asked.via.push_back(place_of(p));
    for (const std::string& cost : request.costs) asked.costs.push_back(map::route_cost_named(cost));
    asked.avoid = request.avoid;
    asked.turning = request.turning;
    asked.lines = request.lines;
    std::vector<Route> routes;
    for (const auto& [cost, way] : map::plan_route(asked).ways) routes.push_back(route_of(cost, way));
    return routes;
  });
}

MapComparison compare_maps(const std::filesystem::path& first, const std::filesystem::path& second,
                           const std::filesystem::path& out) {
  return guarded([&] {
    const map::MapComparison c = map::compare_maps({.first = first, .second = second, .out = out});
    return MapComparison{classes_of(c.change), classes_of(c.significance), c.files};
  });
}

Raster read_raster(const std::filesystem::path& file) {
  return guarded([&] {
    const terrain::RasterSource source = terrain::RasterSource::open_as_it_lies(file);
    const terrain::MapGrid& grid = source.grid();
    return Raster{.columns = grid.columns,
                  .rows = grid.rows,
                  .west = grid.west,
                  .north = grid.north,
                  .cell_width = grid.cell_width,
                  .cell_height = grid.cell_height,
                  .crs = grid.crs_wkt,
                  .value = source.read({0, 0, grid.columns, grid.rows}).value};
  });
}

}  // namespace gonogo::api
