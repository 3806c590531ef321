#include "pipeline/map/write/map_exports.h"

#include <algorithm>

#include "base/file.h"
#include "base/version.h"
#include "pipeline/map/write/map_record.h"
#include "terrain/raster/overlay.h"
#include "terrain/raster/polygons.h"

namespace gonogo::map {
namespace fs = std::filesystem;
using terrain::GlobePlace;
using terrain::MapGrid;
namespace {

Json numbers(std::initializer_list<double> values) {
  Json list = Json::array();
  for (const double v : values) list.push_back(Json(v));
  return list;
}

Json polygon_of(const terrain::DegreeRing& ring) {
  Json list = Json::array(), rings = Json::array();
  for (const auto& [x, y] : ring) list.push_back(numbers({x, y}));
  rings.push_back(list);
  return rings;
}

/// Cut at the antimeridian (RFC 7946, section 3.1.9).
Json outline(const GlobePlace& place) {
  Json geometry = Json::object(), parts = Json::array();
  for (const terrain::DegreeRing& ring : place.outline) parts.push_back(polygon_of(ring));
  const bool one = place.outline.size() == 1;
  geometry["type"] = one ? "Polygon" : "MultiPolygon";
  geometry["coordinates"] = one ? parts.items().front() : parts;
  return geometry;
}

/// STAC 1.0.0, projection extension 1.1.0. The rasters' time is not stated, so the interval is open; STAC asks for one.
Json properties(const MapRequest& request, const ExportedMap& map) {
  const MapGrid& grid = map.grid;
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
  if (!map.place)
    json["gonogo:degrees"] = "not known";
  else if (!map.place->is_wgs84)
    json["gonogo:degrees"] = map.place->system;
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

/// Without a place the geometry is null and there is no bbox, as STAC asks for.
Json stac_item(const MapRequest& request, const ExportedMap& map) {
  Json item = Json::object(), assets = Json::object(), extensions = Json::array();
  item["type"] = "Feature";
  item["stac_version"] = "1.0.0";
  extensions.push_back(Json("https://stac-extensions.github.io/projection/v1.1.0/schema.json"));
  item["stac_extensions"] = extensions;
  item["id"] = "gonogo-" + request.model.hash.substr(0, 12) + "-" + request.region.file.stem().string();
  item["geometry"] = Json();
  if (map.place) {
    const terrain::DegreeBox& box = map.place->box;
    item["geometry"] = outline(*map.place);
    item["bbox"] = numbers({box.west, box.south, box.east, box.north});
  }
  item["properties"] = properties(request, map);
  item["links"] = Json::array();
  for (const MapLayer& layer : map.layers)
    assets[layer.file] =
        asset(layer.file + ".tif", layer.info.name, "image/tiff; application=geotiff; profile=cloud-optimized", "data");
  assets["page"] = asset("index.html", "page", "text/html", "overview");
  assets["figure"] = asset("map.png", "figure", "image/png", "overview");
  assets["polygons"] = asset("classes.gpkg", "polygons of equal class", "application/geopackage+sqlite3", "data");
  item["assets"] = assets;
  return item;
}

/// An earlier map in the folder may have left a file that this one does not write.
void remove_unless_written(const fs::path& file, const MapSummary& summary) {
  std::error_code ignored;
  if (std::find(summary.files.begin(), summary.files.end(), file) == summary.files.end()) fs::remove(file, ignored);
}

}  // namespace

void write_map_exports(const MapRequest& request, const ExportedMap& map, MapSummary& summary) {
  const auto file = [&](const char* name) { return request.out / name; };
  const auto legend = class_legend(request.colour_blind_safe);
  terrain::write_class_polygons(file("classes.gpkg"), file("go.tif"), map.grid, legend);
  summary.files.push_back(file("classes.gpkg"));
  std::string about = "Go/NoGo map of " + vehicle_text(request.model) + ", " + heading_text(request.rules) + ", " +
                      request.rules.fidelity + ".";
  for (const std::string& remark : summary.remarks) about += " " + remark + ".";
  if (map.place) {
    const terrain::OverlayAnswer overlay = terrain::write_overlay(
        file("overlay.kml"), file("overlay.png"), file("go.tif"), *map.place, request.region.name, about, legend);
    for (const fs::path& written : overlay.files) summary.files.push_back(written);
    if (!overlay.why_not.empty()) summary.remarks.push_back(no_overlay(overlay.why_not));
  }
  for (const char* name : {"overlay.kml", "overlay.png", "overlay_2.png"}) remove_unless_written(file(name), summary);
  write_file_atomically(file("stac.json"), stac_item(request, map).dump(2) + "\n");
  summary.files.push_back(file("stac.json"));
  if (!request.model.speed) return;
  write_file_atomically(file("speed_curve.csv"), map.speeds.csv());
  summary.files.push_back(file("speed_curve.csv"));
}

std::string no_overlay(const std::string& because) {
  return "there is no overlay.kml and overlay.png for globes: " + because;
}

}  // namespace gonogo::map
