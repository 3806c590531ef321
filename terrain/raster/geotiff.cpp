#include "terrain/raster/geotiff.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "base/first_error.h"
#include "base/record_log.h"
#include "terrain/raster/cog.h"
#include "terrain/raster/layer_style.h"
#include "terrain/raster/tile_codec.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;

using ClassCounts = std::array<std::uint64_t, 256>;

struct GeoTiffWriter::State {
  fs::path path;
  MapGrid grid;
  LayerInfo info;
  std::vector<CogLevel> levels;
  bool keep = false;
  RecordLog tiles;
};

namespace {

/// Mean of the valid ones of four cells.
float together(const std::array<float, 4>& cells) {
  float sum = 0;
  int count = 0;
  for (const float v : cells)
    if (v != float(kFloatNoData)) {
      sum += v;
      ++count;
    }
  return count > 0 ? sum / float(count) : float(kFloatNoData);
}

/// The most frequent valid one of four cells; of equally frequent ones the higher code, which is the more cautious.
std::uint8_t together(const std::array<std::uint8_t, 4>& cells) {
  int best = 0;
  auto frequent = std::uint8_t(kClassNoData);
  for (const std::uint8_t v : cells) {
    if (v == std::uint8_t(kClassNoData)) continue;
    const int count = int(std::count(cells.begin(), cells.end(), v));
    if (count > best || (count == best && v > frequent)) {
      best = count;
      frequent = v;
    }
  }
  return frequent;
}

/// Fills one quarter of a tile from the tile of the next larger level that lies there.
template <class Cell>
void halve(const std::vector<Cell>& from, std::vector<Cell>& to, int right, int below) {
  constexpr int half = kTileCells / 2;
  for (int row = 0; row < half; ++row)
    for (int column = 0; column < half; ++column) {
      const std::size_t i = std::size_t(2 * row) * kTileCells + std::size_t(2 * column);
      to[std::size_t(row + below * half) * kTileCells + std::size_t(column + right * half)] =
          together(std::array<Cell, 4>{from[i], from[i + 1], from[i + kTileCells], from[i + kTileCells + 1]});
    }
}

void count_classes(const std::vector<std::uint8_t>& cells, ClassCounts& counts) {
  for (const std::uint8_t v : cells) ++counts[v];
}
void count_classes(const std::vector<float>&, ClassCounts&) {}

/// One tile of an overview. Cells beyond the level's edge are nodata in every tile, so they need no rule.
template <class Cell>
std::string overview_tile(const RecordLog& tiles, const std::vector<CogLevel>& levels, std::size_t level,
                          std::uint32_t tile, double nodata, ClassCounts* counts) {
  const CogLevel &here = levels[level], &finer = levels[level - 1];
  const int across = int(tile) % here.tiles_across(), down = int(tile) / here.tiles_across();
  std::vector<Cell> cells(kTileArea, Cell(nodata)), from;
  for (int below = 0; below < 2; ++below)
    for (int right = 0; right < 2; ++right) {
      const int x = 2 * across + right, y = 2 * down + below;
      if (x >= finer.tiles_across() || y >= finer.tiles_down()) continue;
      const std::uint32_t number = first_tile(levels, level - 1) + std::uint32_t(y * finer.tiles_across() + x);
      decode_tile(tiles.read(number), from, tiles.path().string());
      if (counts) count_classes(from, *counts);
      halve(from, cells, right, below);
    }
  return encode_tile(cells);
}

template <class Cell>
ClassCounts make_overviews(RecordLog& tiles, const std::vector<CogLevel>& levels, double nodata, int threads) {
  ClassCounts counts{};
  FirstError error;
  for (std::size_t level = 1; level < levels.size(); ++level)
#pragma omp parallel num_threads(threads)
  {
    ClassCounts own{};
#pragma omp for schedule(dynamic, 1)
    for (std::uint32_t t = 0; t < levels[level].tiles(); ++t)
      error.guard([&] {
        tiles.append(first_tile(levels, level) + t,
                     overview_tile<Cell>(tiles, levels, level, t, nodata, level == 1 ? &own : nullptr));
      });
#pragma omp critical
    for (std::size_t i = 0; i < own.size(); ++i) counts[i] += own[i];
  }
  error.rethrow();
  if (levels.size() == 1) {
    std::vector<Cell> cells;
    decode_tile(tiles.read(0), cells, tiles.path().string());
    count_classes(cells, counts);
  }
  return counts;
}

fs::path scratch_of(const fs::path& path) { return path.parent_path() / ("." + path.stem().string() + ".scratch"); }

template <class Cell>
std::string encode_window(const Tile& tile, int left, int top, double nodata) {
  std::vector<Cell> cells(kTileArea, Cell(nodata));
  for (int row = 0; row < std::min(kTileCells, tile.rows - top); ++row)
    for (int column = 0; column < std::min(kTileCells, tile.columns - left); ++column) {
      const float v = tile.at(left + column, top + row);
      if (!std::isnan(v)) cells[std::size_t(row) * kTileCells + std::size_t(column)] = Cell(v);
    }
  return encode_tile(cells);
}

}  // namespace

GeoTiffWriter::GeoTiffWriter(const fs::path& path, const MapGrid& grid, const LayerInfo& info, const std::string& key)
    : state_(new State{.path = path,
                       .grid = grid,
                       .info = info,
                       .levels = cog_levels(grid.columns, grid.rows),
                       .keep = !key.empty(),
                       .tiles = RecordLog(scratch_of(path), key)}) {
  GONOGO_ASSERT(!info.legend.empty());
}

GeoTiffWriter::~GeoTiffWriter() {
  if (!state_->keep) state_->tiles.remove();
}

void GeoTiffWriter::write(Window window, const Tile& tile) {
  GONOGO_ASSERT(tile.columns == window.columns && tile.rows == window.rows);
  GONOGO_ASSERT(window.column % kTileCells == 0 && window.row % kTileCells == 0);
  const int across = state_->levels.front().tiles_across();
  for (int top = 0; top < window.rows; top += kTileCells)
    for (int left = 0; left < window.columns; left += kTileCells) {
      const int number = (window.row + top) / kTileCells * across + (window.column + left) / kTileCells;
      state_->tiles.append(std::uint32_t(number), state_->info.classes
                                                      ? encode_window<std::uint8_t>(tile, left, top, kClassNoData)
                                                      : encode_window<float>(tile, left, top, kFloatNoData));
    }
}

bool GeoTiffWriter::has_tile(int column, int row) const {
  return state_->tiles.has(
      std::uint32_t(row / kTileCells * state_->levels.front().tiles_across() + column / kTileCells));
}

void GeoTiffWriter::forget() { state_->tiles.remove(); }

void GeoTiffWriter::finish(int threads) {
  State& s = *state_;
  const int thread_count = threads > 0 ? threads : omp_get_max_threads();
  const ClassCounts counts = s.info.classes
                                 ? make_overviews<std::uint8_t>(s.tiles, s.levels, kClassNoData, thread_count)
                                 : make_overviews<float>(s.tiles, s.levels, kFloatNoData, thread_count);
  const CogTiles tiles = {[&](std::uint32_t t) { return s.tiles.size_of(t); },
                          [&](std::uint32_t t) { return s.tiles.read(t); }};
  replace_file_atomically(s.path, [&](const fs::path& file) { write_cog(file, s.grid, s.info, s.levels, tiles); });
  if (s.info.classes) write_file_atomically(s.path.string() + ".aux.xml", side_file(s.info, counts));
  write_file_atomically(fs::path(s.path).replace_extension(".qml"), qgis_style(s.info));
}

}  // namespace gonogo::terrain
