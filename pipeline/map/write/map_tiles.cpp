#include "pipeline/map/write/map_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "base/units.h"

namespace gonogo::map {

namespace fs = std::filesystem;
using terrain::kTileCells;
using terrain::MapGrid;
using terrain::Tile;
using terrain::Window;
namespace {

/// A cell of a reduced copy, and the cell of the tile that it shows.
struct Pick {
  int to = 0, from = 0;
};

/// The ones among `count` reduced cells whose source lies in [begin, begin + length).
template <class Source>
std::vector<Pick> picks(int count, int begin, int length, const Source& source) {
  std::vector<Pick> list;
  for (int to = 0; to < count; ++to)
    if (const int from = source(to) - begin; from >= 0 && from < length) list.push_back({to, from});
  return list;
}

struct Picks {
  std::vector<Pick> rows, columns;
};

Picks picture_picks(const Picture& picture, const MapGrid& grid, Window window) {
  const auto source = [](int cells, int reduced) { return [=](int i) { return int((i + 0.5) * cells / reduced); }; };
  return {picks(picture.shade.rows, window.row, window.rows, source(grid.rows, picture.shade.rows)),
          picks(picture.shade.columns, window.column, window.columns, source(grid.columns, picture.shade.columns))};
}

Picks page_picks(const PageCells& page, Window window) {
  const auto source = [&](int i) { return i * page.step + page.step / 2; };
  return {picks(page.rows, window.row, window.rows, source),
          picks(page.columns, window.column, window.columns, source)};
}

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// As (position, cells).
void put_counts(std::string& out, const std::map<std::uint32_t, std::uint64_t>& counts) {
  put(out, std::uint32_t(counts.size()));
  for (const auto& [position, count] : counts) {
    put(out, position);
    put(out, count);
  }
}

class Reader {
 public:
  Reader(const std::string& bytes, const std::string& where) : bytes_(bytes), where_(where) {}
  template <class T>
  T get() {
    T value{};
    if (at_ + sizeof value > bytes_.size())
      throw DeviceError(where_ + ": a tile of the unfinished map is damaged; remove the file and start again");
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

 private:
  const std::string &bytes_, &where_;
  std::size_t at_ = 0;
};

/// Cells by class of speed, the last entry unknown ones; only what occurs, as (position, cells).
std::map<std::uint32_t, std::uint64_t> speeds_of(const TileLayers& tile, const std::vector<MapLayer>& layers) {
  std::map<std::uint32_t, std::uint64_t> cells;
  const auto speed = find_layer(layers, "speed");
  if (!speed) return cells;
  for (std::size_t i = 0; i < tile.mark.size(); ++i) {
    if (!tile.mark[i].has_slope()) continue;
    const campaign::Verdict verdict = tile.result[i].verdict;
    const bool passed = campaign::passes(verdict);
    const float metres = tile.layer[*speed].value[i] / float(kKmPerHour);  // in a second
    if (verdict == campaign::Verdict::unknown || (passed && !has_data(metres)))
      ++cells[SpeedCurve::kSteps];
    else
      ++cells[std::uint32_t(passed ? std::max(1, SpeedCurve::step_of(metres)) : 0)];
  }
  return cells;
}

}  // namespace

Picture::Picture(const MapGrid& grid, int longest) {
  const double scale = std::min(1.0, double(longest) / std::max(grid.columns, grid.rows));
  const int columns = std::max(1, int(std::lround(grid.columns * scale)));
  const int rows = std::max(1, int(std::lround(grid.rows * scale)));
  shade = verdict = reason = p_go = Tile(columns, rows, kNoData);
}

namespace {

/// Digest of a tile as bytes. `shape` gives the sizes of picture and page; its contents are ignored.
std::string digest_of(const TileLayers& tile, const SoilTable& table, const MapGrid& grid, const MapDigest& shape,
                      const std::vector<MapLayer>& layers) {
  const std::size_t reasons = campaign::contract().reasons.size(), verdicts = campaign::contract().verdicts.size();
  std::vector<std::uint64_t> area((verdicts + 1) * reasons, 0), soils(table.soils.size(), 0);
  std::uint64_t steeper = 0, unanswered_ditches = 0;
  std::map<std::uint32_t, std::uint64_t> rules;
  for (std::size_t i = 0; i < tile.mark.size(); ++i) {
    const CellMark& mark = tile.mark[i];
    if (!mark.has_slope()) continue;
    ++area[std::size_t(tile.result[i].verdict) * reasons + std::size_t(tile.result[i].reason)];
    if (mark.has_rule()) ++rules[mark.rule];
    if (!mark.has_soil()) continue;
    ++soils[mark.soil];
    unanswered_ditches += table.has_ditch[mark.soil] && tile.result[i].verdict == campaign::Verdict::unknown;
    steeper += double(tile.slope.value[i]) > table.responses[mark.soil].sampled_slope().maximum;
  }
  std::string bytes;
  put(bytes, steeper);
  put(bytes, unanswered_ditches);
  put_counts(bytes, rules);
  for (const auto count : area) put(bytes, count);
  for (const auto count : soils) put(bytes, count);
  put_counts(bytes, speeds_of(tile, layers));
  const Picks figure = picture_picks(shape.picture, grid, tile.window), page = page_picks(shape.page, tile.window);
  const auto cell = [&](Pick row, Pick column) {
    return std::size_t(row.from) * std::size_t(tile.window.columns) + std::size_t(column.from);
  };
  for (const Pick row : figure.rows)
    for (const Pick column : figure.columns) {
      const std::size_t i = cell(row, column);
      const bool known = tile.mark[i].has_slope();
      put(bytes, tile.shade.value[i]);
      put(bytes, known ? float(int(tile.result[i].verdict)) : kNoData);
      put(bytes, known ? float(int(tile.result[i].reason)) : kNoData);
      put(bytes, tile.p_go.value[i]);
    }
  for (const Pick row : page.rows)
    for (const Pick column : page.columns) {
      const std::size_t i = cell(row, column);
      for (const Tile* values : {&tile.slope, &tile.aspect, &tile.elevation}) put(bytes, values->value[i]);
      put(bytes, tile.mark[i]);
    }
  return bytes;
}

/// Adds the digest of the tile at `window` to `digest` and to the cell counts of `table`. Throws DeviceError for
/// damaged bytes, with `where` first.
void add_digest(const std::string& bytes, Window window, const MapGrid& grid, SoilTable& table, MapDigest& digest,
                const std::string& where) {
  Reader reader(bytes, where);
  digest.steeper += reader.get<std::uint64_t>();
  digest.unanswered_ditches += reader.get<std::uint64_t>();
  for (auto entries = reader.get<std::uint32_t>(); entries > 0; --entries) {
    const auto rule = reader.get<std::uint32_t>();
    digest.rules[rule] += reader.get<std::uint64_t>();
  }
  for (std::size_t verdict = 0; verdict <= campaign::contract().verdicts.size(); ++verdict)
    for (std::size_t reason = 0; reason < campaign::contract().reasons.size(); ++reason)
      if (const auto count = reader.get<std::uint64_t>())
        digest.area.add(campaign::Verdict(verdict), campaign::Reason(reason), count);
  for (auto& cells : table.cells) cells += reader.get<std::uint64_t>();
  for (auto entries = reader.get<std::uint32_t>(); entries > 0; --entries) {
    const auto step = reader.get<std::uint32_t>();
    const auto count = reader.get<std::uint64_t>();
    if (step < std::uint32_t(SpeedCurve::kSteps))
      digest.speeds.add(int(step), count);
    else
      digest.speeds.add_unknown(count);
  }
  Picture& picture = digest.picture;
  const Picks figure = picture_picks(picture, grid, window), page = page_picks(digest.page, window);
  for (const Pick row : figure.rows)
    for (const Pick column : figure.columns)
      for (Tile* values : {&picture.shade, &picture.verdict, &picture.reason, &picture.p_go})
        values->at(column.to, row.to) = reader.get<float>();
  PageCells& cells = digest.page;
  for (const Pick row : page.rows)
    for (const Pick column : page.columns) {
      const std::size_t i = std::size_t(row.to) * std::size_t(cells.columns) + std::size_t(column.to);
      for (std::vector<float>* values : {&cells.slope, &cells.aspect, &cells.elevation})
        (*values)[i] = reader.get<float>();
      cells.mark[i] = reader.get<CellMark>();
    }
}

}  // namespace

MapTiles::MapTiles(const MapRequest& request, const MapGrid& grid, std::vector<MapLayer> layers, const std::string& key)
    : request_(request), grid_(grid), layers_(std::move(layers)), digests_(request.out / ".blocks.scratch", key) {
  for (const MapLayer& layer : layers_) {
    files_.push_back(request.out / (layer.file + ".tif"));
    writers_.push_back(std::make_unique<terrain::GeoTiffWriter>(files_.back(), grid, layer.info, key));
  }
}

bool MapTiles::is_done(std::uint32_t tile, Window window) const {
  return digests_.has(tile) && std::all_of(writers_.begin(), writers_.end(), [&](const auto& writer) {
           return writer->has_tile(window.column, window.row);
         });
}

void MapTiles::evaluate(const MapSources& sources, const SoilTable& table, const MapDigest& shape) {
  const std::vector<Window> tiles = windows_of(grid_, kTileCells, kTileCells);
  std::vector<std::uint32_t> missing;
  for (std::uint32_t b = 0; b < tiles.size(); ++b)
    if (!is_done(b, tiles[b])) missing.push_back(b);
  found_ = tiles.size() - missing.size();
  Progress progress("map", "tiles", tiles.size());
  std::size_t done = found_;
  std::mutex counting;
  for_each_with_own(
      missing.size(), 1, [&] { return sources.again(); },
      [&](MapSources& own, std::size_t i) {
        const Window window = tiles[missing[i]];
        const TileLayers tile = evaluate_tile(own, request_.region, table, layers_, request_.rules, window);
        for (std::size_t l = 0; l < writers_.size(); ++l) writers_[l]->write(window, tile.layer[l]);
        digests_.append(missing[i], digest_of(tile, table, grid_, shape, layers_));
        const std::lock_guard lock(counting);
        progress.update(++done, "", found_);
      },
      request_.threads);
  progress.finish();
}

void MapTiles::collect(SoilTable& table, MapDigest& digest) const {
  const std::vector<Window> tiles = windows_of(grid_, kTileCells, kTileCells);
  for (std::uint32_t b = 0; b < tiles.size(); ++b)
    add_digest(digests_.read(b), tiles[b], grid_, table, digest, digests_.path().string());
}

std::vector<fs::path> MapTiles::finish() {
  Progress progress("map", "layers", writers_.size());
  std::size_t done = 0;
  std::mutex counting;
  const auto finish = [&](std::size_t l) {
    writers_[l]->finish(1);
    const std::lock_guard lock(counting);
    progress.update(++done);
  };
  for_each_on_host(writers_.size(), 1, finish, request_.threads);
  progress.finish();
  return files_;
}

void MapTiles::forget() {
  for (const auto& writer : writers_) writer->forget();
  digests_.remove();
}

}  // namespace gonogo::map
