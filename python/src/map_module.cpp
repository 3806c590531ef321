// gonogo._map: maps, routes and rasters. The one module that loads GDAL.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "base/files/shipped.h"
#include "pipeline/map/map_request.h"
#include "pipeline/map/route/plan_route.h"
#include "pipeline/map/write/compare_maps.h"
#include "python/src/binding.h"
#include "terrain/raster/layer/geotiff.h"
#include "terrain/raster/raster_source.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

/// With vehicles that go by their names found.
map::MapRequest request_of(map::MapFiles files) {
  for (std::filesystem::path* file : {&files.vehicle, &files.whole_vehicle})
    if (!file->empty()) *file = shipped_file("vehicles", "vehicle", file->string());
  return map::read_map_request(files);
}

Members make_map(map::MapFiles files, const std::string& out) {
  return members_of(long_call([&] {
    files.out = out;
    const map::MapSummary summary = map::make_map(request_of(std::move(files)));
    Json json, written = Json::array();
    json["area_km2"] = summary.area_km2;
    for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts)
      json["share"][verdict.name] = summary.area.share(campaign::Verdict(verdict.code));
    for (const auto& file : summary.files) written.push_back(file.string());
    json["files"] = std::move(written);
    json["remarks"] = summary.remarks;
    json["reused"] = summary.reused;
    return json;
  }));
}

using Place = std::pair<double, double>;

map::Place place_of(const Place& p) { return {p.first, p.second}; }

/// A route's request whose file members are still to be set.
map::RouteRequest route_request(std::optional<Place> from, std::optional<Place> to, const std::vector<Place>& via,
                                const std::vector<std::string>& costs, bool eight_directions, double turning,
                                const std::string& departure, double interval) {
  map::RouteRequest request;
  if (from) request.from = place_of(*from);
  if (to) request.to = place_of(*to);
  for (const Place& p : via) request.via.push_back(place_of(p));
  for (const std::string& cost : costs) request.costs.push_back(map::route_cost_named(cost));
  request.eight_directions = eight_directions;
  request.turning = turning;
  if (!departure.empty()) request.departure = map::parse_departure(departure, "route: departure");
  request.interval = interval;
  return request;
}

Members plan_route(map::RouteRequest request, const map::MapFiles& files) {
  return members_of(long_call([&] {
    request.map = request_of(files);
    return map::route_json(map::plan_route(request));
  }));
}

Members compare_maps(const std::string& first, const std::string& second, const std::string& out) {
  return members_of(long_call([&] {
    map::CompareRequest request{.first = first, .second = second, .out = out};
    return map::compare_json(map::compare_maps(request));
  }));
}

using Transform = std::array<double, 6>;

/// Values [row, column], the affine transform a, b, c, d, e, f of rasterio, and the coordinate system as WKT2.
std::tuple<Array<float>, Transform, std::string> read_raster(const std::string& path) {
  terrain::MapGrid grid;
  terrain::Tile tile;
  long_call([&] {
    const terrain::RasterSource source = terrain::RasterSource::open_as_it_lies(path);
    grid = source.grid();
    tile = source.read({0, 0, grid.columns, grid.rows});
  });
  const std::size_t rows = std::size_t(grid.rows), columns = std::size_t(grid.columns);
  return {array_of(std::move(tile.value), {rows, columns}),
          Transform{grid.cell_width, 0, grid.west, 0, -grid.cell_height, grid.north}, grid.crs_wkt};
}

/// Writes values [row, column] of a north-up raster.
void write_raster(const std::string& path, const ArrayIn<float, 2>& values, const Transform& t, const std::string& crs,
                  const std::string& unit) {
  terrain::Tile tile(int(values.shape(1)), int(values.shape(0)), 0);
  std::copy_n(values.data(), tile.value.size(), tile.value.begin());
  long_call([&] { terrain::write_values(path, tile, {t[2], t[5], t[0], -t[4]}, crs, unit); });
}

/// A path as Python's str; an empty one leaves a file out.
template <class Request>
void file_property(nb::class_<Request>& c, const char* name, std::filesystem::path Request::*file) {
  c.def_prop_rw(
      name, [file](const Request& r) { return (r.*file).string(); },
      [file](Request& r, const std::string& path) { r.*file = path; });
}

void set_members(map::MapFiles& files, const std::vector<std::string>& paths) {
  files.members.assign(paths.begin(), paths.end());
}

void bind_files(nb::module_& m) {
  using map::MapFiles;
  nb::class_<MapFiles> c(m, "MapFiles", "The files that a map is made from; an empty path leaves one out.");
  c.def(nb::init<>());
  file_property(c, "model", &MapFiles::model);
  file_property(c, "region", &MapFiles::region);
  file_property(c, "dem", &MapFiles::dem);
  file_property(c, "crossing_model", &MapFiles::crossing_model);
  file_property(c, "study", &MapFiles::study);
  file_property(c, "dataset", &MapFiles::dataset);
  file_property(c, "vehicle", &MapFiles::vehicle);
  file_property(c, "whole_vehicle", &MapFiles::whole_vehicle);
  c.def("set_members", &set_members, nb::arg("paths"));
  c.def_rw("soil", &MapFiles::soil);
  c.def_rw("height_unit", &MapFiles::height_unit);
  c.def_rw("flat_is_ground", &MapFiles::flat_is_ground);
  c.def_rw("moisture", &MapFiles::moisture);
  c.def_rw("cone_index", &MapFiles::cone_index);
  c.def_rw("set", &MapFiles::set);
  c.def_rw("max_speed_km_h", &MapFiles::max_speed_km_h);
  c.def_rw("heading", &MapFiles::heading);
  c.def_rw("colour_blind_safe", &MapFiles::colour_blind_safe);
  c.def_rw("threads", &MapFiles::threads);
}

void bind_route_request(nb::module_& m) {
  using namespace nb::literals;
  using map::RouteRequest;
  nb::class_<RouteRequest> c(m, "RouteRequest", "Places, costs and files of routes; an empty path leaves a file out.");
  c.def(nb::new_(&route_request), "start"_a.none(), "end"_a.none(), "via"_a, "costs"_a, "eight_directions"_a,
        "turning"_a, "departure"_a, "interval"_a);
  file_property(c, "avoid", &RouteRequest::avoid);
  file_property(c, "lines", &RouteRequest::lines);
  file_property(c, "reach", &RouteRequest::reach);
  file_property(c, "isochrones", &RouteRequest::isochrones);
  file_property(c, "costmap", &RouteRequest::costmap);
  file_property(c, "grid_map", &RouteRequest::grid_map);
  file_property(c, "regions", &RouteRequest::regions);
}

}  // namespace
}  // namespace gonogo::python

NB_MODULE(_map, m) {
  using namespace gonogo;
  using namespace nb::literals;
  m.doc() = "Maps, routes and rasters. Use the package gonogo; names here may change.";
  python::raise_errors_of_core();
  python::bind_files(m);
  python::bind_route_request(m);
  m.def("make_map", &python::make_map, "files"_a, "out"_a, "Writes the map's folder. Returns the summary.");
  m.def("plan_route", &python::plan_route, "request"_a, "files"_a, "Writes the files asked for. Returns the routes.");
  m.def("compare_maps", &python::compare_maps, "first"_a, "second"_a, "out"_a, "Returns the comparison.");
  m.def("write_raster", &python::write_raster, "path"_a, "values"_a, "transform"_a, "crs"_a, "unit"_a,
        "Writes values [row, column], row 0 in the north, as GeoTIFF.");
  m.def("read_raster", &python::read_raster, "path"_a,
        "Values [row, column], NaN: nodata; affine transform; coordinate system as WKT2.");
}
