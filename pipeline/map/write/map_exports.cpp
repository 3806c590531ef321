#include "pipeline/map/write/map_exports.h"

#include "base/file.h"
#include "base/version.h"
#include "pipeline/map/write/map_record.h"
#include "terrain/raster/overlay.h"
#include "terrain/raster/polygons.h"

namespace gonogo::map {
namespace fs = std::filesystem;
using terrain::MapGrid;
namespace {

Json numbers(std::initializer_list<double> values) {
  Json list = Json::array();
  for (const double v : values) list.push_back(Json(v));
  return list;
}

Json outline(const MapGrid& grid) {
  Json ring = Json::array(), rings = Json::array(), geometry = Json::object();
  const auto corners = terrain::degree_corners(grid);
  for (std::size_t i = 0; i <= corners.size(); ++i) ring.push_back(numbers({corners[i % 4][0], corners[i % 4][1]}));
  rings.push_back(ring);
  geometry["type"] = "Polygon";
  geometry["coordinates"] = rings;
  return geometry;
}

/// STAC 1.0.0, projection extension 1.1.0. The rasters' time is not stated, so the interval is open; STAC asks for one.
Json properties(const MapRequest& request, const MapGrid& grid) {
  Json json = Json::object(), shape = Json::array();
  json["title"] = "Go/NoGo map: " + request.region.name;
  json["description"] = "Mobility of " + vehicle_text(request.model) + ", " + heading_text(request.rules) +
                        ". The time of the rasters is not stated: the interval stands for all times.";
  json["datetime"] = Json();
  json["start_datetime"] = "0001-01-01T00:00:00Z";
  json["end_datetime"] = "9999-12-31T00:00:00Z";
  if (grid.crs_code.rfind("EPSG:", 0) == 0)
    json["proj:epsg"] = std::stoi(grid.crs_code.substr(5));
  else
    json["proj:epsg"] = Json();
  json["proj:wkt2"] = grid.crs_wkt;
  shape.push_back(Json(grid.rows));
  shape.push_back(Json(grid.columns));
  json["proj:shape"] = shape;
  json["proj:transform"] = numbers({grid.cell_width, 0, grid.west, 0, -grid.cell_height, grid.north});
  json["gonogo:version"] = program_version();
  json["gonogo:model_hash"] = request.model.hash;
  return json;
}

Json asset(const std::string& href, const std::string& title, const std::string& type, const char* role) {
  Json json = Json::object(), roles = Json::array();
  json["href"] = "./" + href;
  json["title"] = title;
  json["type"] = type;
  roles.push_back(Json(role));
  json["roles"] = roles;
  return json;
}

Json stac_item(const MapRequest& request, const MapGrid& grid, const std::vector<MapLayer>& layers) {
  const terrain::DegreeBox box = terrain::degree_box(grid);
  Json item = Json::object(), assets = Json::object(), extensions = Json::array();
  item["type"] = "Feature";
  item["stac_version"] = "1.0.0";
  extensions.push_back(Json("https://stac-extensions.github.io/projection/v1.1.0/schema.json"));
  item["stac_extensions"] = extensions;
  item["id"] = "gonogo-" + request.model.hash.substr(0, 12) + "-" + request.region.file.stem().string();
  item["geometry"] = outline(grid);
  item["bbox"] = numbers({box.west, box.south, box.east, box.north});
  item["properties"] = properties(request, grid);
  item["links"] = Json::array();
  for (const MapLayer& layer : layers)
    assets[layer.file] =
        asset(layer.file + ".tif", layer.info.name, "image/tiff; application=geotiff; profile=cloud-optimized", "data");
  assets["page"] = asset("index.html", "page", "text/html", "overview");
  assets["figure"] = asset("map.png", "figure", "image/png", "overview");
  assets["polygons"] = asset("classes.gpkg", "polygons of equal class", "application/geopackage+sqlite3", "data");
  item["assets"] = assets;
  return item;
}

}  // namespace

std::vector<fs::path> write_map_exports(const MapRequest& request, const MapGrid& grid,
                                        const std::vector<MapLayer>& layers, const MapSummary& summary,
                                        const SpeedCurve& speeds) {
  const fs::path go = request.out / "go.tif";
  const auto legend = class_legend(request.colour_blind_safe);
  std::vector<fs::path> files = {request.out / "classes.gpkg", request.out / "overlay.png", request.out / "overlay.kml",
                                 request.out / "stac.json"};
  terrain::write_class_polygons(files[0], go, grid, legend);
  std::string about = "Go/NoGo map of " + vehicle_text(request.model) + ", " + heading_text(request.rules) + ", " +
                      request.rules.fidelity + ".";
  for (const std::string& remark : summary.remarks) about += " " + remark + ".";
  terrain::write_overlay(files[2], files[1], go, request.region.name, about, legend);
  write_file_atomically(files[3], stac_item(request, grid, layers).dump(2) + "\n");
  if (request.model.speed) {
    files.push_back(request.out / "speed_curve.csv");
    write_file_atomically(files.back(), speeds.csv());
  }
  return files;
}

}  // namespace gonogo::map
