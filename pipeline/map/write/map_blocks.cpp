#include "pipeline/map/write/map_blocks.h"

#include <omp.h>

#include <algorithm>
#include <atomic>

#include "base/cancel.h"
#include "base/first_error.h"
#include "base/progress.h"
#include "terrain/raster/tile_codec.h"

namespace gonogo::map {
namespace fs = std::filesystem;
using terrain::kTileCells;
using terrain::MapGrid;
using terrain::Tile;
using terrain::Window;
namespace {

void copy_rows(const Tile& from, int row, Tile& to) {
  std::copy(from.value.begin(), from.value.end(), to.value.begin() + std::ptrdiff_t(row) * to.columns);
}

void copy_rows(const TileLayers& from, int row, TileLayers& to) {
  for (Tile TileLayers::*values : {&TileLayers::elevation, &TileLayers::slope, &TileLayers::aspect, &TileLayers::shade,
                                   &TileLayers::soil, &TileLayers::rule})
    copy_rows(from.*values, row, to.*values);
  for (std::size_t l = 0; l < from.layer.size(); ++l) copy_rows(from.layer[l], row, to.layer[l]);
}

/// The window by strips of `rows` rows.
TileLayers evaluate_strips(const MapSources& sources, const MapRequest& request, const SoilTable& table,
                           const std::vector<MapLayer>& layers, Window window, int rows) {
  if (rows >= window.rows) return evaluate_tile(sources, request.region, table, layers, request.rules, window);
  const Tile empty(window.columns, window.rows, 0);
  TileLayers whole{.window = window,
                   .elevation = empty,
                   .slope = empty,
                   .aspect = empty,
                   .shade = empty,
                   .soil = empty,
                   .rule = empty,
                   .layer = std::vector<Tile>(layers.size(), empty)};
  for (int row = 0; row < window.rows; row += rows) {
    const Window strip = {window.column, window.row + row, window.columns, std::min(rows, window.rows - row)};
    copy_rows(evaluate_tile(sources, request.region, table, layers, request.rules, strip), row, whole);
  }
  return whole;
}

}  // namespace

MapTiles::MapTiles(const MapRequest& request, const MapGrid& grid, std::vector<MapLayer> layers, const std::string& key)
    : request_(request), grid_(grid), layers_(std::move(layers)), digests_(request.out / ".blocks.scratch", key) {
  for (const MapLayer& layer : layers_) {
    files_.push_back(request.out / (layer.file + ".tif"));
    writers_.push_back(std::make_unique<terrain::GeoTiffWriter>(files_.back(), grid, layer.info, key));
  }
}

std::vector<Window> MapTiles::windows() const {
  std::vector<Window> list;
  for (int row = 0; row < grid_.rows; row += kTileCells)
    for (int column = 0; column < grid_.columns; column += kTileCells)
      list.push_back(
          {column, row, std::min(kTileCells, grid_.columns - column), std::min(kTileCells, grid_.rows - row)});
  return list;
}

bool MapTiles::is_done(std::uint32_t tile, Window window) const {
  return digests_.has(tile) && std::all_of(writers_.begin(), writers_.end(), [&](const auto& writer) {
           return writer->has_tile(window.column, window.row);
         });
}

void MapTiles::evaluate(const MapSources& sources, const SoilTable& table, const MapDigest& shape) {
  const std::vector<Window> tiles = windows();
  std::vector<std::uint32_t> missing;
  for (std::uint32_t b = 0; b < tiles.size(); ++b)
    if (!is_done(b, tiles[b])) missing.push_back(b);
  found_ = tiles.size() - missing.size();
  Progress progress("map", "tiles", tiles.size());
  std::size_t done = found_;
  FirstError error;
  const int threads = std::min(request_.threads > 0 ? request_.threads : omp_get_max_threads(), int(missing.size()));
#pragma omp parallel num_threads(std::max(1, threads))
  {
    std::optional<MapSources> own;
#pragma omp for schedule(dynamic, 1)
    for (std::size_t i = 0; i < missing.size(); ++i)
      error.guard([&] {
        stop_if_cancelled();
        if (!own) own = sources.again();
        const Window window = tiles[missing[i]];
        const TileLayers tile = evaluate_strips(*own, request_, table, layers_, window, request_.strip_rows);
        for (std::size_t l = 0; l < writers_.size(); ++l) writers_[l]->write(window, tile.layer[l]);
        digests_.append(missing[i], digest_of(tile, table, grid_, shape, layers_));
#pragma omp critical(gonogo_map_progress)
        progress.update(++done, "", found_);
      });
  }
  error.rethrow();
  progress.finish();
}

void MapTiles::collect(SoilTable& table, MapDigest& digest) const {
  const std::vector<Window> tiles = windows();
  for (std::uint32_t b = 0; b < tiles.size(); ++b)
    add_digest(digests_.read(b), tiles[b], grid_, table, digest, digests_.path().string());
}

std::vector<fs::path> MapTiles::finish() {
  FirstError error;
  Progress progress("map", "layers", writers_.size());
  std::size_t done = 0;
  const int threads = request_.threads > 0 ? request_.threads : omp_get_max_threads();
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (std::size_t l = 0; l < writers_.size(); ++l)
    error.guard([&] {
      stop_if_cancelled();
      writers_[l]->finish(1);
#pragma omp critical(gonogo_map_progress)
      progress.update(++done);
    });
  error.rethrow();
  progress.finish();
  return files_;
}

void MapTiles::forget() {
  for (const auto& writer : writers_) writer->forget();
  digests_.remove();
}

}  // namespace gonogo::map
