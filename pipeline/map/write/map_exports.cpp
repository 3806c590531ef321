#include "pipeline/map/write/map_exports.h"

#include <algorithm>

#include "base/files/file.h"
#include "base/format.h"
#include "base/version.h"
#include "pipeline/report/figure/map_figure.h"
#include "terrain/raster/layer/layer_picture.h"
#include "terrain/raster/vector/write_vector.h"

namespace gonogo::map {

namespace fs = std::filesystem;
using terrain::GlobePlace;
using terrain::MapGrid;
namespace {

Json polygon_of(const terrain::DegreeRing& ring) {
  Json::Array list;
  for (const auto& [x, y] : ring) list.push_back(Json::Array{x, y});
  return Json::Array{Json(list)};
}

/// Cut at the antimeridian (RFC 7946, section 3.1.9).
Json outline(const GlobePlace& place) {
  Json::Array parts;
  for (const terrain::DegreeRing& ring : place.outline) parts.push_back(polygon_of(ring));
  if (parts.size() == 1) return Json::Object{{"type", "Polygon"}, {"coordinates", parts.front()}};
  return Json::Object{{"type", "MultiPolygon"}, {"coordinates", parts}};
}

/// STAC 1.0.0, projection extension 1.1.0. The rasters' time is not stated, so the interval is open; STAC asks for one.
Json properties(const MapRequest& request, const ExportedMap& map) {
  const MapGrid& grid = map.grid;
  Json json;
  json["title"] = "Go/NoGo map: " + request.region.name;
  json["description"] = "Mobility of " + vehicle_text(request.model) + ", " + heading_text(request.rules) +
                        ". The time of the rasters is not stated: the interval stands for all times.";
  json["datetime"] = Json();
  json["start_datetime"] = "0001-01-01T00:00:00Z";
  json["end_datetime"] = "9999-12-31T00:00:00Z";
  json["proj:epsg"] = grid.crs_code.rfind("EPSG:", 0) == 0 ? Json(std::stoi(grid.crs_code.substr(5))) : Json();
  json["proj:wkt2"] = grid.crs_wkt;
  json["proj:shape"] = Json::Array{grid.rows, grid.columns};
  json["proj:transform"] = Json::Array{grid.cell_width, 0.0, grid.west, 0.0, -grid.cell_height, grid.north};
  if (!map.place)
    json["gonogo:degrees"] = "not known";
  else if (!map.place->is_wgs84)
    json["gonogo:degrees"] = map.place->system;
  json["gonogo:version"] = program_version();
  json["gonogo:model_hash"] = request.model.hash;
  return json;
}

Json asset(const std::string& href, const std::string& title, const std::string& type, const char* role) {
  return Json::Object{{"href", "./" + href}, {"title", title}, {"type", type}, {"roles", Json::Array{role}}};
}

/// Without a place the geometry is null and there is no bbox, as STAC asks for.
Json stac_item(const MapRequest& request, const ExportedMap& map) {
  Json item, assets;
  item["type"] = "Feature";
  item["stac_version"] = "1.0.0";
  item["stac_extensions"] = Json::Array{"https://stac-extensions.github.io/projection/v1.1.0/schema.json"};
  item["id"] = "gonogo-" + request.model.hash.substr(0, 12) + "-" + request.region.file.stem().string();
  item["geometry"] = Json();
  if (map.place) {
    const terrain::DegreeBox& box = map.place->box;
    item["geometry"] = outline(*map.place);
    item["bbox"] = Json::Array{box.west, box.south, box.east, box.north};
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

namespace {

std::string number(double x) { return line("%g", x); }

void add_legends(const MapRequest& request, const MapSummary& summary, report::MapFigure& figure) {
  for (const auto& entry : class_legend(request.colour_blind_safe))
    figure.classes.push_back(
        {int(entry.value), entry.label, entry.colour, summary.area.share(campaign::Verdict(int(entry.value)))});
  for (const auto& entry : reason_legend()) {
    double share = 0;
    for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts)
      share += summary.area.share(campaign::Verdict(verdict.code), campaign::Reason(int(entry.value)));
    if (share > 0) figure.reasons.push_back({int(entry.value), entry.label, entry.colour, share});
  }
  for (const auto& stop : p_go_legend()) figure.p_go_ramp.push_back({stop.value, stop.colour});
}

/// One curve per soil that occurs, the most frequent first.
void add_curves(const SoilTable& table, const MapSummary& summary, report::MapFigure& figure) {
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < table.soils.size(); ++s)
    if (table.soils.size() == 1 || table.cells[s] > 0) order.push_back(s);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return table.cells[a] > table.cells[b]; });
  for (const std::size_t s : order) {
    report::FigureCurve curve;
    curve.label = table.soils[s].name;
    if (summary.area.total() > 0 && table.cells[s] > 0)
      curve.label += line("  %.1f %%", 100.0 * double(table.cells[s]) / double(summary.area.total()));
    const SoilResponse& response = table.responses[s];
    for (double slope = 0; slope <= response.sampled_slope().maximum; slope += 1 / kSlopeSteps) {
      curve.slope_deg.push_back(slope);
      curve.p_go.push_back(response.at(slope).p_go);
    }
    figure.curves.push_back(std::move(curve));
    figure.steepest_sampled_deg = response.sampled_slope().maximum;
  }
}

void add_notes(const MapRequest& request, const terrain::MapGrid& grid, const MapSummary& summary,
               report::MapFigure& figure) {
  const MapRules& rules = request.rules;
  figure.notes.push_back("go: P(go) \u2265 " + number(rules.go) + ";  slow-go: " + number(rules.no_go) +
                         " \u2264 P(go) < " + number(rules.go) + ", or slower than the go speed;  no-go: P(go) < " +
                         number(rules.no_go) +
                         ".  P(go) is the probability that a valid trial ends in go or slow-go.  Grey is never a "
                         "guess: the soil is not known or too soft, or nothing like it was simulated.");
  for (const std::string& remark : summary.remarks) figure.notes.push_back(remark);
  figure.notes.push_back("Elevation: " + request.region.elevation.source +
                         (request.region.soil_class ? ".  Soil: " + request.region.soil_class->source : ""));
  figure.notes.push_back((grid.crs_code.empty() ? grid.crs_name : grid.crs_name + " (" + grid.crs_code + ")") +
                         ", cells " + number(grid.cell_width_m()) + " m, slope by Horn 1981.  gonogo " +
                         program_version() + " " + program_revision() + ", model " + request.model.hash.substr(0, 12));
}

}  // namespace

void write_map_figure(const MapRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                      const MapSummary& summary, const Picture& picture, const std::filesystem::path& path) {
  report::MapFigure figure;
  figure.title = (request.model.vehicle.empty() ? "" : request.model.vehicle + ", ") + request.region.name;
  figure.subtitle =
      "Go/NoGo map of " + vehicle_text(request.model) + "; " + conditions_text(request) + "; " + request.rules.fidelity;
  figure.grid = grid;
  figure.shade = picture.shade;
  figure.verdict = picture.verdict;
  figure.reason = picture.reason;
  figure.p_go = picture.p_go;
  figure.area_km2 = summary.area_km2;
  figure.go_threshold = request.rules.go;
  figure.no_go_threshold = request.rules.no_go;
  add_legends(request, summary, figure);
  add_curves(table, summary, figure);
  add_notes(request, grid, summary, figure);
  report::draw_map_figure(path, figure);
}

}  // namespace gonogo::map
