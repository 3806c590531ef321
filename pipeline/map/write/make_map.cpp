#include "pipeline/map/write/make_map.h"

#include <cstdio>

#include "base/error.h"
#include "base/file.h"
#include "base/line.h"
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
  const auto& because = points.outside_because();
  if (because.empty()) return;
  const std::string more = std::to_string(because.size() - 1);
  remarks.push_back(where + because.front() +
                    (because.size() > 1 ? ", and " + more + " more values of it are not sampled" : ""));
}

std::vector<std::string> remarks_on(const MapSummary& summary, const Region& region, const SoilTable& table) {
  std::vector<std::string> remarks;
  for (std::size_t s = 0; s < table.soils.size(); ++s)
    if (table.cells[s] > 0)
      remark_on_soil(region, table.soils[s], table.responses[s].points(),
                     double(table.cells[s]) / double(summary.area.total()), remarks);
  if (summary.area.total() == 0)
    remarks.push_back("no cell has a slope: every cell is at the border or next to one without elevation");
  if (const double share = summary.area.share(campaign::Verdict::unknown, campaign::Reason::input_missing); share > 0)
    remarks.push_back("the soil is unknown on " + percent(share) +
                      " of the area: nodata, or a code the region's table does not list");
  if (const double share = summary.area.share(campaign::Verdict::unknown, campaign::Reason::land_unknown); share > 0)
    remarks.push_back("the land cover is unknown on " + percent(share) +
                      " of the area: nodata, or a code the region's table does not list");
  for (const std::string& soil : table.without_samples)
    remarks.push_back(soil + " is unknown: no sample has that water content");
  return remarks;
}

/// Writes the files that need every tile.
void finish_map(const MapRequest& request, const MapGrid& grid, const SoilTable& table, const Metadata& metadata,
                const std::vector<MapLayer>& layers, const MapDigest& digest, MapSummary& summary) {
  write_file_atomically(request.out / "area.csv", summary.area.csv(grid.cell_area_m2()));
  write_map_figure(request, grid, table, summary, digest.picture, request.out / "map.png");
  write_map_page(request, grid, table, summary, digest.page, metadata, request.out / "index.html");
  for (const char* name : {"area.csv", "map.png", "index.html"}) summary.files.push_back(request.out / name);
  for (const fs::path& file : write_map_exports(request, grid, layers, summary, digest.speeds))
    summary.files.push_back(file);
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
  SoilTable table =
      make_soil_table(request.model, request.region, request.rules, gradient_error(request.region.elevation, grid));
  create_folder(request.out);
  const Metadata metadata = map_metadata(request, origin);
  MapTiles tiles(request, grid,
                 map_layers(request.rules, !request.model.measures.empty(), bool(request.model.novelty),
                            request.colour_blind_safe, metadata),
                 origin.dump());
  MapDigest digest{{}, Picture(grid, kPictureCells), PageCells(grid)};
  evaluate_or_forget(tiles, sources, table, digest);
  tiles.collect(table, digest);
  MapSummary summary;
  summary.area = digest.area;
  summary.area_km2 = double(summary.area.total()) * grid.cell_area_m2() * 1e-6;
  summary.remarks = remarks_on(summary, request.region, table);
  if (!sources.elevation.how_warped().empty()) summary.remarks.push_back(sources.elevation.how_warped());
  summary.tiles_found = tiles.found();
  summary.files = tiles.finish();
  finish_map(request, grid, table, metadata, tiles.layers(), digest, summary);
  write_map_record(request, origin, summary);
  summary.files.push_back(request.out / "map.json");
  tiles.forget();
  return summary;
}

}  // namespace gonogo::map
