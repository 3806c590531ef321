#include "pipeline/map/make_map.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "base/cancel.h"
#include "base/file.h"
#include "base/progress.h"
#include "pipeline/map/map_figure.h"
#include "pipeline/map/map_record.h"
#include "pipeline/map/picture.h"
#include "pipeline/map/soil_table.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/slope.h"

namespace gonogo::pipeline {
namespace fs = std::filesystem;
using terrain::GeoTiffWriter;
using terrain::MapGrid;
using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;
using terrain::Window;
namespace {

constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();
constexpr int kPictureCells = 1600;  // along the longer side of the figure's map

struct Inputs {
  RasterSource elevation;
  std::optional<RasterSource> soil_class;
};

Inputs open_inputs(const Region& region) {
  Inputs inputs{RasterSource::open_elevation(region.elevation.file), std::nullopt};
  if (region.soil_class)
    inputs.soil_class =
        RasterSource::open_on_grid(region.soil_class->file, inputs.elevation.grid(), RasterKind::classes);
  return inputs;
}

SoilTable make_soil_table(const MapRequest& request) {
  SoilTable table;
  table.soils = request.region.soils;
  if (table.soils.empty())
    table.soils.push_back({.code = 0, .name = "all soils", .note = "", .samples = {}, .values = {}});
  for (const Soil& soil : table.soils) {
    table.index_of_code[soil.code] = int(table.responses.size());
    table.responses.emplace_back(request.model, request.rules,
                                 soil_points(request.region, soil, request.rules.values, request.rules.draws));
  }
  table.cells.assign(table.soils.size(), 0);
  return table;
}

/// Position of a cell's soil in the table, or -1 when the raster does not say or the table does not list it.
int soil_of(const SoilTable& table, const Tile* codes, int column, int row) {
  if (!codes) return 0;
  const float code = codes->at(column, row);
  if (std::isnan(code)) return -1;
  const auto found = table.index_of_code.find(int(code));
  return found == table.index_of_code.end() || float(found->first) != code ? -1 : found->second;
}

void fill_cell(BlockLayers& block, const SoilTable& table, int soil, float slope, int column, int row) {
  if (std::isnan(slope)) return;
  block.soil.at(column, row) = float(soil);
  CellAnswer answer{{Verdict::unknown, Reason::input_missing}, kNoData, 1};
  if (soil >= 0) answer = table.responses[std::size_t(soil)].at(slope);
  block.verdict.at(column, row) = float(int(answer.result.verdict));
  block.reason.at(column, row) = float(int(answer.result.reason));
  block.p_go.at(column, row) = answer.p_go;
  block.outside_share.at(column, row) = answer.outside_share;
}

/// Cells depend on nothing but their own inputs, so threads and blocks cannot change a bit.
BlockLayers evaluate_block(const Inputs& inputs, const SoilTable& table, Window window, int threads) {
  const MapGrid& grid = inputs.elevation.grid();
  const Tile elevation =
      inputs.elevation.read({window.column - 1, window.row - 1, window.columns + 2, window.rows + 2});
  std::optional<Tile> codes;
  if (inputs.soil_class) codes = inputs.soil_class->read(window);
  const terrain::CellSize cell = {grid.cell_width_m(), grid.cell_height_m()};
  const Tile slope = terrain::slope_degrees(elevation, cell, threads);
  const Tile empty(window.columns, window.rows, kNoData);
  BlockLayers block{window, terrain::hillshade(elevation, cell, 315, 45, threads), empty, empty, empty, empty, empty};
  const int thread_count = threads > 0 ? threads : omp_get_max_threads();
#pragma omp parallel for schedule(static) num_threads(thread_count)
  for (int row = 0; row < window.rows; ++row)
    for (int column = 0; column < window.columns; ++column)
      fill_cell(block, table, soil_of(table, codes ? &*codes : nullptr, column, row), slope.at(column, row), column,
                row);
  return block;
}

void count_cells(const BlockLayers& block, AreaCount& area, SoilTable& table) {
  for (std::size_t i = 0; i < block.verdict.value.size(); ++i) {
    if (std::isnan(block.verdict.value[i])) continue;
    area.add(Verdict(int(block.verdict.value[i])), Reason(int(block.reason.value[i])));
    if (block.soil.value[i] >= 0) ++table.cells[std::size_t(block.soil.value[i])];
  }
}

/// The four rasters of a map, written side by side.
class MapLayers {
 public:
  MapLayers(const MapRequest& request, const MapGrid& grid, const Metadata& metadata)
      : verdict_(request.out / "go.tif", grid, class_layer(request.colour_blind_safe, metadata)),
        p_go_(request.out / "p_go.tif", grid, p_go_layer(metadata)),
        reason_(request.out / "reason.tif", grid, reason_layer(metadata)),
        outside_(request.out / "outside_share.tif", grid, outside_share_layer(metadata)) {}

  void write(const BlockLayers& block) {
    verdict_.write(block.window, block.verdict);
    p_go_.write(block.window, block.p_go);
    reason_.write(block.window, block.reason);
    outside_.write(block.window, block.outside_share);
  }

  std::vector<fs::path> finish(const fs::path& out, int threads) {
    for (GeoTiffWriter* writer : {&verdict_, &p_go_, &reason_, &outside_}) writer->finish(threads);
    return {out / "go.tif", out / "p_go.tif", out / "reason.tif", out / "outside_share.tif"};
  }

 private:
  GeoTiffWriter verdict_, p_go_, reason_, outside_;
};

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
  return text;
}

std::vector<std::string> remarks_on(const MapSummary& summary, const SoilTable& table) {
  std::vector<std::string> remarks;
  for (std::size_t s = 0; s < table.soils.size(); ++s) {
    const auto& because = table.responses[s].outside_because();
    if (because.empty() || table.cells[s] == 0) continue;
    remarks.push_back(table.soils[s].name + " (" + percent(double(table.cells[s]) / double(summary.area.total())) +
                      " of the area): " + because.front() +
                      (because.size() > 1
                           ? ", and " + std::to_string(because.size() - 1) + " more values of it are not sampled"
                           : ""));
  }
  if (const double share = summary.area.share(Verdict::unknown, Reason::input_missing); share > 0)
    remarks.push_back("soil is not known on " + percent(share) +
                      " of the area: nodata, or a code the region's table does not list");
  return remarks;
}

}  // namespace

MapSummary make_map(const MapRequest& request) {
  const Inputs inputs = open_inputs(request.region);
  const Json origin = map_inputs(request);
  if (auto finished = find_finished_map(request, origin)) return *finished;
  const MapGrid& grid = inputs.elevation.grid();
  create_folder(request.out);
  SoilTable table = make_soil_table(request);
  MapLayers layers(request, grid, map_metadata(request, origin));
  Picture picture(grid, kPictureCells);
  MapSummary summary;
  Progress progress("map", "rows", std::size_t(grid.rows));
  for (int row = 0; row < grid.rows; row += request.block_rows) {
    stop_if_cancelled();
    const Window window = {0, row, grid.columns, std::min(request.block_rows, grid.rows - row)};
    const BlockLayers block = evaluate_block(inputs, table, window, request.threads);
    layers.write(block);
    picture.take(grid, block);
    count_cells(block, summary.area, table);
    progress.update(std::size_t(row + window.rows));
  }
  progress.finish();
  summary.area_km2 = double(summary.area.total()) * grid.cell_area_m2() * 1e-6;
  summary.remarks = remarks_on(summary, table);
  summary.files = layers.finish(request.out, request.threads);
  write_file_atomically(request.out / "area.csv", summary.area.csv(grid.cell_area_m2()));
  write_map_figure(request, grid, table, summary, picture, request.out / "map.png");
  for (const char* name : {"area.csv", "map.png"}) summary.files.push_back(request.out / name);
  write_map_record(request, origin, summary);
  summary.files.push_back(request.out / "map.json");
  return summary;
}

}  // namespace gonogo::pipeline
