#include "pipeline/map/write/map_page.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/file.h"
#include "base/line.h"
#include "base/units.h"
#include "base/version.h"
#include "pipeline/map/page/page.h"
#include "pipeline/map/write/map_record.h"
#include "pipeline/map/write/page_tables.h"
#include "terrain/raster/globe.h"

namespace gonogo::map {
namespace {

constexpr std::uint16_t kNone = 65535, kNoData = 255, kNoSoil = 254;

double finite_or(double value, double fallback) { return std::isfinite(value) ? value : fallback; }

struct Heights {
  double lowest = 0, highest = 1, step = 0.1;  // [m]
};

Heights heights_of(const PageCells& cells) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (std::size_t i = 0; i < cells.soil.size(); ++i) {
    if (std::isnan(cells.soil[i])) continue;
    low = std::min(low, cells.elevation[i]);
    high = std::max(high, cells.elevation[i]);
  }
  Heights heights{std::floor(finite_or(low, 0)), std::ceil(finite_or(high, 1)), 0.1};
  while ((heights.highest - heights.lowest) / heights.step > 65000) heights.step *= 2;
  return heights;
}

std::vector<Blob> cell_blobs(const PageCells& cells, const Heights& heights) {
  const std::size_t width = std::size_t(cells.columns), count = cells.soil.size();
  Blob slope{"slope", 16, width, std::vector<std::uint16_t>(count, 0)}, aspect = slope, height = slope, soil = slope;
  aspect.name = "aspect";
  height.name = "height";
  soil.name = "soil";
  soil.bits = 8;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(cells.soil[i])) {
      soil.value[i] = kNoData;
      height.value[i] = kNone;
      continue;
    }
    slope.value[i] = std::uint16_t(std::lround(cells.slope[i] * kSlopeSteps));
    aspect.value[i] = std::isnan(cells.aspect[i]) ? 0 : std::uint16_t(rounded_aspect(cells.aspect[i]));
    height.value[i] = std::uint16_t(std::lround((cells.elevation[i] - heights.lowest) / heights.step));
    soil.value[i] = cells.soil[i] < 0 ? kNoSoil : std::uint16_t(cells.soil[i]);
  }
  std::vector<Blob> blobs = {slope, aspect, height, soil};
  if (std::any_of(cells.rule.begin(), cells.rule.end(), [](float r) { return r > 0; })) {
    Blob rule{"rule", 8, width, std::vector<std::uint16_t>(count, 0)};
    for (std::size_t i = 0; i < count; ++i) rule.value[i] = std::uint16_t(cells.rule[i]);
    blobs.push_back(std::move(rule));
  }
  return blobs;
}

Json grid_json(const terrain::MapGrid& grid) {
  Json json = Json::object();
  json["columns"] = grid.columns;
  json["rows"] = grid.rows;
  json["west"] = grid.west;
  json["north"] = grid.north;
  json["cell_width_m"] = grid.cell_width_m();
  json["cell_height_m"] = grid.cell_height_m();
  json["metres_per_unit"] = grid.metres_per_unit;
  json["unit_name"] = grid.unit_name;
  json["crs"] = grid.crs_code.empty() ? grid.crs_name : grid.crs_name + " (" + grid.crs_code + ")";
  return json;
}

/// Null where longitude and latitude are not known. Steps of 1e-7 degrees, 1 cm.
Json degrees_json(const terrain::MapGrid& grid) {
  constexpr int most = 33;
  const terrain::GlobeAnswer globe = terrain::place_on_globe(grid);
  if (!globe.place) return Json();
  const auto nodes = terrain::degree_nodes(grid, *globe.place, most);
  if (!nodes) return Json();
  Json json = Json::object();
  const auto list = [](const std::vector<double>& values) {
    Json array = Json::array();
    for (const double v : values) array.push_back(Json(std::round(v * 1e7) / 1e7));
    return array;
  };
  json["wgs84"] = globe.place->is_wgs84;
  json["columns"] = nodes->columns;
  json["rows"] = nodes->rows;
  json["longitude"] = list(nodes->longitude);
  json["latitude"] = list(nodes->latitude);
  return json;
}

Json verdicts_json() {
  Json list = Json::array();
  for (const campaign::VerdictInfo& v : campaign::contract().verdicts) {
    Json entry = Json::object();
    entry["code"] = v.code;
    entry["name"] = v.name;
    entry["label"] = v.label;
    entry["colour"] = v.colour;
    entry["colour_blind_safe"] = v.colour_blind_safe;
    list.push_back(entry);
  }
  return list;
}

Json reasons_json() {
  Json list = Json::array();
  for (const campaign::ReasonInfo& r : campaign::contract().reasons) {
    Json entry = Json::object();
    entry["code"] = r.code;
    entry["name"] = r.name;
    entry["label"] = r.label;
    entry["about"] = r.about;
    entry["colour"] = r.colour;
    list.push_back(entry);
  }
  return list;
}

Json land_json(const Region& region) {
  Json list = Json::array();
  for (const LandRule& rule : land_rules(region)) {
    Json entry = Json::object();
    entry["of"] = rule.reason == campaign::Reason::soft_soil ? "Strength" : "Land cover";
    entry["name"] = rule.name;
    entry["verdict"] = rule.verdict ? int(*rule.verdict) : 0;
    entry["reason"] = int(rule.reason);
    list.push_back(entry);
  }
  return list;
}

Json texts(const std::vector<std::string>& lines) { return Json(lines); }

Json note(const std::string& title, const std::vector<std::string>& lines) {
  return Json::Array{Json(title), texts(lines)};
}

/// "0.0665", "452 J/m", "2113 J/m": three digits, never in exponent form.
std::string quantity(double x, const std::string& unit) {
  const std::string number = x >= 100 ? line("%.0f", x) : line("%.3g", x);
  return unit == "-" ? number : number + " " + unit;
}

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Json speed_note(const MapRequest& request) {
  const ResistanceFit& fit = request.model.speed->resistance;
  const double sampled = kKmPerHour * fit.fastest;
  std::vector<std::string> lines = {
      "Top speed is where the driveline's tractive force at full throttle equals slope and motion resistance; ride, "
      "sight, brakes and bends are not in it",
      line("Motion resistance over weight: %.3f + %.2f per metre of rut + %.3f slip + %.4f per m/s, error %.3f, "
           "from %zu trials that measured %.2f to %.2f",
           fit.constant, fit.per_rut, fit.per_slip, fit.per_speed, fit.error, fit.trials, fit.lowest, fit.highest),
      line("Trials drove up to %.1f km/h. Faster speeds add the inertia of all soil in the ruts to their resistance; "
           "no trial checks that",
           sampled),
      "Downhill it is no faster than on the level; where slope or soil were not sampled there is no speed"};
  if (std::isfinite(request.rules.max_speed))
    lines.push_back(line("No faster than %g km/h, the limit that was asked for", kKmPerHour * request.rules.max_speed));
  return note("Top speed", lines);
}

Json notes_json(const MapRequest& request, const MapSummary& summary, const PageCells& cells) {
  const MapRules& rules = request.rules;
  Json notes = Json::array();
  notes.push_back(
      note("What the classes mean",
           {line("go: P(go) of %g or more, and go likelier than slow-go", rules.go),
            line("slow-go: P(go) from %g to %g, or slow-go likelier than go", rules.no_go, rules.go),
            line("no-go: P(go) below %g; steeper uphill than sampled where the steepest sampled slope is "
                 "no-go already",
                 rules.no_go),
            "unknown: the soil is not known or too soft, or nothing like it was simulated; never a guess"}));
  std::vector<std::string> limits = summary.remarks;
  limits.push_back(
      "Slopes are rounded to 1/64 degree uphill and to 1/2 degree for other headings; azimuths are from "
      "grid north");
  if (cells.step > 1)
    limits.push_back(
        line("This page shows every %d. cell of the map in both directions; the GeoTIFF files beside it "
             "hold all of them",
             cells.step));
  notes.push_back(note("Limits", limits));
  if (request.model.speed) notes.push_back(speed_note(request));
  if (request.model.measures.empty()) return notes;
  std::vector<std::string> fits;
  for (const MeasureFit& fit : request.model.measures)
    fits.push_back(spaced(fit.name) + ": error " + quantity(fit.error, fit.unit) +
                   " left out in turn, standard deviation " + quantity(fit.spread, fit.unit) +
                   line(", %zu trials that passed", fit.trials));
  notes.push_back(note("Expected measures", fits));
  return notes;
}

Json provenance_json(const MapRequest& request, const terrain::MapGrid& grid, const Metadata& metadata) {
  Json list = Json::array();
  const auto add = [&list](const std::string& name, const std::string& value) {
    list.push_back(Json::Array{Json(name), Json(value)});
  };
  add("Elevation", request.region.elevation.source + " (" + request.region.elevation.licence + ")");
  if (request.region.soil_class)
    add("Soil", request.region.soil_class->source + " (" + request.region.soil_class->licence + ")");
  if (request.region.land_cover)
    add("Land cover", request.region.land_cover->source + " (" + request.region.land_cover->licence + ")");
  if (request.region.moisture)
    add("Moisture", request.region.moisture->source + " (" + request.region.moisture->licence + ")");
  if (request.region.cone_index)
    add("Cone index", request.region.cone_index->source + " (" + request.region.cone_index->licence + ")");
  if (!request.rules.moisture.empty()) add("Scenario", request.rules.moisture);
  add("Coordinates", grid.crs_code.empty() ? grid.crs_name : grid.crs_name + ", " + grid.crs_code);
  for (const auto& [key, value] : metadata)
    if (key.rfind("GONOGO_", 0) == 0) add(key.substr(7), value);
  return list;
}

constexpr double kFastestShown = 80;  // end of the ramp of speeds [km/h]

double largest(const MapRequest& request, const std::string& name, double fallback) {
  for (const MeasureFit& fit : request.model.measures)
    if (fit.name == name && fit.highest > 0) return fit.highest;
  return fallback;
}

}  // namespace

PageCells::PageCells(const terrain::MapGrid& grid) {
  while (std::int64_t(grid.columns / step) * std::int64_t(grid.rows / step) > kPageCells) ++step;
  columns = std::max(1, grid.columns / step);
  rows = std::max(1, grid.rows / step);
  const std::size_t count = std::size_t(columns) * std::size_t(rows);
  slope.assign(count, std::numeric_limits<float>::quiet_NaN());
  aspect = elevation = soil = slope;
  rule.assign(count, 0);
}

void write_map_page(const MapRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                    const MapSummary& summary, const PageCells& cells, const Metadata& metadata,
                    const std::filesystem::path& path) {
  const Heights heights = heights_of(cells);
  std::vector<Blob> blobs = cell_blobs(cells, heights);
  Json meta = Json::object(), reduced = Json::object(), height = Json::object(), soils = Json::array();
  meta["title"] = map_title(request);
  meta["subtitle"] = "Go/NoGo map of " + request.region.name + "; " + request.rules.fidelity;
  meta["about"] = request.region.about.empty() ? request.region.name : request.region.about;
  meta["grid"] = grid_json(grid);
  meta["degrees"] = degrees_json(grid);
  reduced["columns"] = cells.columns;
  reduced["rows"] = cells.rows;
  reduced["step"] = cells.step;
  meta["cells"] = reduced;
  height["lowest"] = heights.lowest;
  height["highest"] = heights.highest;
  height["step"] = heights.step;
  meta["height"] = height;
  meta["rules"] = rules_json(request.rules);
  meta["height_error"] = request.region.elevation.error * std::sqrt(1 - request.region.elevation.error_correlation);
  meta["slope_steps"] = kSlopeSteps;
  meta["heading_steps"] = kHeadingSteps;
  meta["headings"] = kHeadings;
  meta["verdicts"] = verdicts_json();
  meta["reasons"] = reasons_json();
  for (std::size_t s = 0; s < table.soils.size(); ++s) {
    Json soil = page_soil(request, table.soils[s], table.responses[s]);
    soil["drive"] = add_drive_table(request.model, table.responses[s], int(s), blobs);
    soils.push_back(soil);
    add_soil_blobs(table.responses[s], int(s), blobs);
  }
  meta["soils"] = soils;
  meta["max_speed"] = kFastestShown;
  meta["max_sinkage"] = largest(request, "sinkage", 0.1);
  meta["energy_of"] = request.model.whole_vehicle ? "Energy at the wheels" : "Energy of one wheel";
  meta["not_modelled"] =
      texts({request.region.land_cover ? "obstacles and what other vehicles did to the ground"
                                       : "vegetation, water, obstacles and what other vehicles did to the ground"});
  meta["land"] = land_json(request.region);
  meta["map_heading"] = heading_text(request.rules);
  meta["notes"] = notes_json(request, summary, cells);
  meta["provenance"] = provenance_json(request, grid, metadata);
  write_file_atomically(path, page_file(meta, blobs));
}

}  // namespace gonogo::map
