#include "pipeline/map/write/make_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/file.h"
#include "base/line.h"
#include "base/nearest.h"
#include "base/units.h"
#include "pipeline/map/region/ground_gravity.h"
#include "pipeline/map/write/map_blocks.h"
#include "pipeline/map/write/map_exports.h"
#include "pipeline/map/write/map_figure.h"
#include "pipeline/map/write/map_page.h"
#include "pipeline/map/write/map_record.h"

namespace gonogo::map {
namespace fs = std::filesystem;
using terrain::MapGrid;
namespace {

constexpr int kPictureCells = 1600;  // along the longer side of the figure's map

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
  return text;
}

/// Remarks on a soil of the map: what is too soft, has no texture, or was not sampled.
void remark_on_soil(const Region& region, const Soil& soil, const SoilPoints& points, double share,
                    std::vector<std::string>& remarks) {
  const std::string where = soil.name + " (" + percent(share) + " of the area): ";
  for (const std::string& because : points.soft_because()) remarks.push_back(where + because);
  if (!is_fine_grained(region, soil))
    remarks.push_back(where +
                      "no texture is given; the vehicle's cone index is required only where the friction angle is " +
                      line("below %g degrees", kMinAngleOfSand));
  for (const std::string& because : points.stronger_because()) remarks.push_back(where + because);
  if (!points.outside_because().empty()) remarks.push_back(where + join_words(points.outside_because()));
}

/// Which variables leave what trials sampled, and on which share of the area.
void remark_on_ranges(const OutcomeModel& model, const MapDigest& digest, const SoilTable& table,
                      std::vector<std::string>& remarks) {
  const double total = double(digest.area.total());
  const auto& variables = campaign::contract().variables;
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const bool along = variables[v].name == "slope_along";
    double cells = along ? double(digest.steeper) : 0;
    for (std::size_t s = 0; s < table.soils.size() && !along; ++s)
      if (!table.has_ditch[s]) cells += double(table.cells[s]) * table.responses[s].points().outside_share(v);
    if (cells > 0)
      remarks.push_back(
          variables[v].name +
          line(" lies outside what trials sampled, %g to %g ", model.sampled[v].minimum, model.sampled[v].maximum) +
          variables[v].unit + ", on " + percent(cells / total) + " of the area" +
          (along ? " (uphill)" : " (soils by their shares)"));
  }
}

/// Where trials of ditches answer, and where a ditch between the bounds of geometry stays unknown, and why.
void remark_on_ditches(const MapRequest& request, const MapSources& sources, const MapDigest& digest,
                       const SoilTable& table, std::vector<std::string>& remarks) {
  if (request.model.crossing_sampled.empty() || !request.region.crossing) return;
  double modelled = 0, other_size = 0;
  for (std::size_t s = 0; s < table.soils.size(); ++s)
    if (table.has_ditch[s]) modelled += double(table.cells[s]);
  for (std::size_t k = 0; k < request.region.obstacles.size(); ++k) {
    const auto found = digest.rules.find(std::uint32_t(obstacle_rule(request.region, k, Crossing::unknown) + 1));
    if (request.region.obstacles[k].kind == ObstacleKind::ditch && found != digest.rules.end())
      other_size += double(found->second);
  }
  const double total = double(digest.area.total()), unanswered = double(digest.unanswered_ditches);
  const Range width = request.region.crossing->ditch_width, depth = request.region.crossing->ditch_depth;
  if (modelled > 0) {
    remarks.push_back("trials of ditches decide on " + percent((modelled - unanswered) / total) +
                      " of the area, where a ditch lies between the bounds of geometry; its P(go) is the least of "
                      "the soil's and the ditch's");
    if (sources.ditch_step > 0.05)
      remarks.push_back(line("widths and depths of ditches are rounded up to %g m", sources.ditch_step));
  }
  if (unanswered > 0)
    remarks.push_back("ditches on " + percent(unanswered / total) +
                      " of the area are unknown: their trials sampled no such soil or slope");
  if (other_size > 0)
    remarks.push_back("ditches on " + percent(other_size / total) + " of the area are unknown: their trials sampled " +
                      line("widths of %g to %g m and depths of %g to %g m", width.minimum, width.maximum, depth.minimum,
                           depth.maximum));
}

/// What the map does where nobody said what the soil is.
void remark_on_no_soil(const MapSummary& summary, const SoilTable& table, std::vector<std::string>& remarks) {
  const bool any = std::any_of(table.soils.begin(), table.soils.end(), [](const Soil& s) { return !s.given; });
  if (any)
    remarks.push_back("no soil was given: it may be any USDA texture, so that " +
                      percent(summary.area.share(campaign::Verdict::unknown)) +
                      " of the area is unknown; name a soil with --soil, and a moisture with --moisture");
}

std::vector<std::string> remarks_on(const MapSummary& summary, const MapRequest& request, const MapDigest& digest,
                                    const SoilTable& table) {
  const Region& region = request.region;
  std::vector<std::string> remarks = request.model.remarks;
  if (request.model.gravity != kGravity)
    remarks.push_back("trials and ground have a gravity of " + gravity_text(request.model.gravity));
  remark_on_no_soil(summary, table, remarks);
  for (std::size_t s = 0; s < table.soils.size(); ++s)
    if (table.cells[s] > 0 && !table.has_ditch[s])
      remark_on_soil(region, table.soils[s], table.responses[s].points(),
                     double(table.cells[s]) / double(summary.area.total()), remarks);
  if (summary.area.total() > 0) remark_on_ranges(request.model, digest, table, remarks);
  if (summary.area.total() == 0)
    remarks.push_back("no cell has a slope: every cell is at the border or next to one without elevation");
  const bool given = std::all_of(table.soils.begin(), table.soils.end(), [](const Soil& s) { return s.given; });
  if (const double share = summary.area.share(campaign::Verdict::unknown, campaign::Reason::input_missing);
      given && share > 0)
    remarks.push_back("the soil is unknown on " + percent(share) +
                      " of the area: nodata, or a code the region's table does not list");
  if (const double share = summary.area.share(campaign::Verdict::unknown, campaign::Reason::land_unknown); share > 0)
    remarks.push_back("the land cover is unknown on " + percent(share) +
                      " of the area: nodata, or a code the region's table does not list");
  for (const std::string& soil : table.without_samples)
    remarks.push_back(soil + " is unknown: no sample has that water content");
  return remarks;
}

void remark_on_elevation(const terrain::RasterSource& elevation, std::vector<std::string>& remarks) {
  constexpr double coarse = 100;  // [m]
  for (const std::string& remark : elevation.remarks()) remarks.push_back(remark);
  if (!elevation.how_warped().empty()) remarks.push_back(elevation.how_warped());
  const double cell = std::max(elevation.grid().cell_width_m(), elevation.grid().cell_height_m());
  if (cell > coarse)
    remarks.push_back(
        line("cells are %.4g m wide: slopes are means over such lengths, and ground that a vehicle meets is "
             "steeper in places; cells of at most %g m show more",
             cell, coarse));
}

/// What the map cannot say about its place on the globe.
void remark_on_place(const terrain::GlobeAnswer& globe, std::vector<std::string>& remarks) {
  if (!globe.place)
    remarks.push_back(no_overlay(globe.why_not));
  else if (const std::string remark = terrain::remark_on(*globe.place); !remark.empty())
    remarks.push_back(remark);
}

/// Writes the files that need every tile.
void finish_map(const MapRequest& request, const MapGrid& grid, const SoilTable& table, const Metadata& metadata,
                const std::vector<MapLayer>& layers, const MapDigest& digest, MapSummary& summary) {
  const terrain::GlobeAnswer globe = terrain::place_on_globe(grid);
  remark_on_place(globe, summary.remarks);
  write_file_atomically(request.out / "area.csv", summary.area.csv(grid.cell_area_m2()));
  write_map_figure(request, grid, table, summary, digest.picture, request.out / "map.png");
  write_map_page(request, grid, table, summary, digest.page, metadata, request.out / "index.html");
  for (const char* name : {"area.csv", "map.png", "index.html"}) summary.files.push_back(request.out / name);
  write_map_exports(request, {grid, layers, digest.speeds, globe.place}, summary);
}

/// Removes the scratch files after InputError. After other errors the next run continues from them.
void evaluate_or_forget(MapTiles& tiles, const MapSources& sources, const SoilTable& table, const MapDigest& shape) {
  try {
    tiles.evaluate(sources, table, shape);
  } catch (const InputError&) {
    tiles.forget();
    throw;
  }
}

}  // namespace

MapSummary make_map(const MapRequest& request) {
  const MapSources sources = open_sources(request.region);
  const Json origin = map_inputs(request);
  if (auto finished = find_finished_map(request, origin)) return *finished;
  const MapGrid& grid = sources.elevation.grid();
  require_gravity(request.region, grid.body_radius, request.model.gravity);
  const Region occurring = with_occurring_soils(request.region, sources);
  const double error = gradient_error(request.region.elevation, grid);
  SoilTable table = make_soil_table(request.model, occurring, request.rules, error);
  add_ditches(request.model, occurring, request.rules, error, sources, table);
  create_folder(request.out);
  const Metadata metadata = map_metadata(request, origin);
  MapTiles tiles(request, grid, map_layers(request.rules, request.model, request.colour_blind_safe, metadata),
                 origin.dump());
  MapDigest digest{{}, Picture(grid, kPictureCells), PageCells(grid)};
  evaluate_or_forget(tiles, sources, table, digest);
  tiles.collect(table, digest);
  MapSummary summary;
  summary.gravity = request.model.gravity;
  summary.area = digest.area;
  summary.area_km2 = double(summary.area.total()) * grid.cell_area_m2() * 1e-6;
  summary.remarks = remarks_on(summary, request, digest, table);
  if (summary.area.total() > 0) remark_on_ditches(request, sources, digest, table, summary.remarks);
  remark_on_elevation(sources.elevation, summary.remarks);
  summary.tiles_found = tiles.found();
  summary.files = tiles.finish();
  finish_map(request, grid, table, metadata, tiles.layers(), digest, summary);
  write_map_record(request, origin, summary);
  summary.files.push_back(request.out / "map.json");
  tiles.forget();
  return summary;
}

}  // namespace gonogo::map
