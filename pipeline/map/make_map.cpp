#include "pipeline/map/make_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "base/cancel.h"
#include "base/file.h"
#include "base/progress.h"
#include "pipeline/map/block.h"
#include "pipeline/map/map_figure.h"
#include "pipeline/map/map_page.h"
#include "pipeline/map/map_record.h"
#include "pipeline/map/picture.h"
#include "pipeline/map/soil_table.h"

namespace gonogo::pipeline {
namespace fs = std::filesystem;
using terrain::GeoTiffWriter;
using terrain::MapGrid;
using terrain::Window;
namespace {

constexpr int kPictureCells = 1600;  // along the longer side of the figure's map

void count_cells(const BlockLayers& block, AreaCount& area, SoilTable& table) {
  for (std::size_t i = 0; i < block.verdict().value.size(); ++i) {
    if (std::isnan(block.verdict().value[i])) continue;
    area.add(Verdict(int(block.verdict().value[i])), Reason(int(block.reason().value[i])));
    if (block.soil.value[i] >= 0) ++table.cells[std::size_t(block.soil.value[i])];
  }
}

/// The rasters of a map, written side by side.
class LayerFiles {
 public:
  LayerFiles(const fs::path& out, const MapGrid& grid, const std::vector<MapLayer>& layers) {
    for (const MapLayer& layer : layers) {
      files_.push_back(out / (layer.file + ".tif"));
      writers_.push_back(std::make_unique<GeoTiffWriter>(files_.back(), grid, layer.info));
    }
  }

  void write(const BlockLayers& block) {
    for (std::size_t l = 0; l < writers_.size(); ++l) writers_[l]->write(block.window, block.layer[l]);
  }

  const std::vector<fs::path>& finish(int threads) {
    for (const auto& writer : writers_) writer->finish(threads);
    return files_;
  }

 private:
  std::vector<fs::path> files_;
  std::vector<std::unique_ptr<GeoTiffWriter>> writers_;
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
  const MapSources sources = open_sources(request.region);
  const Json origin = map_inputs(request);
  if (auto finished = find_finished_map(request, origin)) return *finished;
  const MapGrid& grid = sources.elevation.grid();
  create_folder(request.out);
  SoilTable table =
      make_soil_table(request.model, request.region, request.rules, gradient_error(request.region.elevation, grid));
  const Metadata metadata = map_metadata(request, origin);
  const std::vector<MapLayer> layers = map_layers(request.rules, !request.model.measures.empty(),
                                                  bool(request.model.novelty), request.colour_blind_safe, metadata);
  LayerFiles files(request.out, grid, layers);
  Picture picture(grid, kPictureCells);
  PageCells cells(grid);
  MapSummary summary;
  Progress progress("map", "rows", std::size_t(grid.rows));
  for (int row = 0; row < grid.rows; row += request.block_rows) {
    stop_if_cancelled();
    const Window window = {0, row, grid.columns, std::min(request.block_rows, grid.rows - row)};
    const BlockLayers block = evaluate_block(sources, table, layers, request.rules, window, request.threads);
    files.write(block);
    picture.take(grid, block);
    cells.take(block);
    count_cells(block, summary.area, table);
    progress.update(std::size_t(row + window.rows));
  }
  progress.finish();
  summary.area_km2 = double(summary.area.total()) * grid.cell_area_m2() * 1e-6;
  summary.remarks = remarks_on(summary, table);
  summary.files = files.finish(request.threads);
  write_file_atomically(request.out / "area.csv", summary.area.csv(grid.cell_area_m2()));
  write_map_figure(request, grid, table, summary, picture, request.out / "map.png");
  write_map_page(request, grid, table, summary, cells, metadata, request.out / "index.html");
  for (const char* name : {"area.csv", "map.png", "index.html"}) summary.files.push_back(request.out / name);
  write_map_record(request, origin, summary);
  summary.files.push_back(request.out / "map.json");
  return summary;
}

}  // namespace gonogo::pipeline
