// gonogo._map: maps, routes and rasters. The one module that loads GDAL.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "base/shipped.h"
#include "pipeline/map/route/plan_route.h"
#include "pipeline/map/write/compare_maps.h"
#include "pipeline/map/write/map_request.h"
#include "python/src/arrays.h"
#include "python/src/calls.h"
#include "python/src/module.h"
#include "terrain/raster/raster_source.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

map::MapFiles files_of(const std::string& model, const std::string& region, const std::string& dem,
                       const std::string& soil, const std::string& vehicle, const std::string& whole_vehicle,
                       const std::string& dataset, const std::string& moisture, const std::string& heading,
                       std::vector<std::string> settings, double max_speed_km_h) {
  const auto vehicle_file = [](const std::string& name) {
    return name.empty() ? std::filesystem::path() : shipped_file("vehicles", "vehicle", name);
  };
  map::MapFiles files;
  files.model = model;
  files.region = region;
  files.dem = dem;
  files.soil = soil;
  files.vehicle = vehicle_file(vehicle);
  files.whole_vehicle = vehicle_file(whole_vehicle);
  files.dataset = dataset;
  files.moisture = moisture;
  files.heading = heading;
  files.set = std::move(settings);
  files.max_speed_km_h = max_speed_km_h;
  return files;
}

std::string make_map(map::MapFiles files, const std::string& out) {
  return long_call([&] {
    files.out = out;
    const map::MapSummary summary = map::make_map(map::read_map_request(files));
    Json json, written = Json::array();
    json["area_km2"] = summary.area_km2;
    for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts)
      json["share"][verdict.name] = summary.area.share(campaign::Verdict(verdict.code));
    for (const auto& file : summary.files) written.push_back(file.string());
    json["files"] = std::move(written);
    json["remarks"] = summary.remarks;
    json["reused"] = summary.reused;
    return json.dump();
  });
}

using Place = std::pair<double, double>;

std::string plan_route(const map::MapFiles& files, std::optional<Place> from, std::optional<Place> to,
                       const std::vector<std::string>& costs, const std::string& lines, const std::string& reach) {
  return long_call([&] {
    map::RouteRequest request;
    request.map = map::read_map_request(files);
    if (from) request.from = map::Place{from->first, from->second};
    if (to) request.to = map::Place{to->first, to->second};
    for (const std::string& cost : costs) request.costs.push_back(map::route_cost_named(cost));
    request.lines = lines;
    request.reach = reach;
    return map::plan_route(request).dump();
  });
}

std::string compare_maps(const std::string& first, const std::string& second, const std::string& out) {
  return long_call([&] {
    map::CompareRequest request;
    request.first = first;
    request.second = second;
    request.out = out;
    return map::compare_maps(request).dump();
  });
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

}  // namespace
}  // namespace gonogo::python

NB_MODULE(_map, m) {
  using namespace gonogo;
  using namespace nb::literals;
  m.doc() = "Maps, routes and rasters. Use the package gonogo; names here may change.";
  python::raise_errors_of_core();
  nb::class_<map::MapFiles>(m, "MapFiles", "The files that a map is made from; \"\" leaves one out.")
      .def(
          "__init__",
          [](map::MapFiles* self, const std::string& model, const std::string& region, const std::string& dem,
             const std::string& soil, const std::string& vehicle, const std::string& whole_vehicle,
             const std::string& dataset, const std::string& moisture, const std::string& heading,
             std::vector<std::string> settings, double max_speed_km_h) {
            new (self) map::MapFiles(python::files_of(model, region, dem, soil, vehicle, whole_vehicle, dataset,
                                                      moisture, heading, std::move(settings), max_speed_km_h));
          },
          "model"_a, "region"_a = "", "dem"_a = "", "soil"_a = "", "vehicle"_a = "", "whole_vehicle"_a = "",
          "dataset"_a = "", "moisture"_a = "", "heading"_a = "", "settings"_a = std::vector<std::string>(),
          "max_speed_km_h"_a = 0.0);
  m.def("make_map", &python::make_map, "files"_a, "out"_a, "Writes the map's folder. Returns JSON of the summary.");
  m.def("plan_route", &python::plan_route, "files"_a, "start"_a.none(), "end"_a.none(), "costs"_a, "lines"_a = "",
        "reach"_a = "", "Writes the files asked for. Returns JSON of the routes.");
  m.def("compare_maps", &python::compare_maps, "first"_a, "second"_a, "out"_a, "Returns JSON of the comparison.");
  m.def("read_raster", &python::read_raster, "path"_a,
        "Values [row, column], NaN: nodata; affine transform; coordinate system as WKT2.");
}
