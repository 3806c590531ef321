#include "pipeline/map/write/block_digest.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "base/error.h"
#include "base/units.h"

namespace gonogo::map {

using terrain::MapGrid;
using terrain::Tile;
using terrain::Window;
namespace {

/// A cell of a reduced copy, and the cell of the tile that it shows.
struct Pick {
  int to = 0, from = 0;
};

/// Those of `count` reduced cells whose source lies in [begin, begin + length).
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
  std::size_t speed = 0;
  while (speed < layers.size() && layers[speed].file != "speed") ++speed;
  if (speed == layers.size()) return cells;
  for (std::size_t i = 0; i < tile.verdict().value.size(); ++i) {
    const float verdict = tile.verdict().value[i];
    if (std::isnan(verdict)) continue;
    const auto v = campaign::Verdict(int(verdict));
    const bool passed = campaign::passes(v);
    const float metres = tile.layer[speed].value[i] / float(kKmPerHour);  // in a second
    if (v == campaign::Verdict::unknown || (passed && std::isnan(metres)))
      ++cells[SpeedCurve::kSteps];
    else
      ++cells[std::uint32_t(passed ? std::max(1, SpeedCurve::step_of(metres)) : 0)];
  }
  return cells;
}

}  // namespace

std::string digest_of(const TileLayers& tile, const SoilTable& table, const MapGrid& grid, const MapDigest& shape,
                      const std::vector<MapLayer>& layers) {
  const std::size_t reasons = campaign::contract().reasons.size(), verdicts = campaign::contract().verdicts.size();
  std::vector<std::uint64_t> area((verdicts + 1) * reasons, 0), soils(table.soils.size(), 0);
  std::uint64_t steeper = 0, unanswered_ditches = 0;
  std::map<std::uint32_t, std::uint64_t> rules;
  for (std::size_t i = 0; i < tile.verdict().value.size(); ++i) {
    if (std::isnan(tile.verdict().value[i])) continue;
    ++area[std::size_t(tile.verdict().value[i]) * reasons + std::size_t(tile.reason().value[i])];
    if (tile.rule.value[i] > 0) ++rules[std::uint32_t(tile.rule.value[i])];
    if (!(tile.soil.value[i] >= 0)) continue;
    const auto soil = std::size_t(tile.soil.value[i]);
    ++soils[soil];
    unanswered_ditches += table.has_ditch[soil] && tile.verdict().value[i] == float(campaign::Verdict::unknown);
    steeper += double(tile.slope.value[i]) > table.responses[soil].sampled_slope().maximum;
  }
  std::string bytes;
  put(bytes, steeper);
  put(bytes, unanswered_ditches);
  put_counts(bytes, rules);
  for (const auto count : area) put(bytes, count);
  for (const auto count : soils) put(bytes, count);
  put_counts(bytes, speeds_of(tile, layers));
  const Picks figure = picture_picks(shape.picture, grid, tile.window), page = page_picks(shape.page, tile.window);
  for (const Pick row : figure.rows)
    for (const Pick column : figure.columns)
      for (const Tile* values : {&tile.shade, &tile.verdict(), &tile.reason(), &tile.p_go()})
        put(bytes, values->at(column.from, row.from));
  for (const Pick row : page.rows)
    for (const Pick column : page.columns)
      for (const Tile* values : {&tile.slope, &tile.aspect, &tile.elevation, &tile.soil, &tile.rule})
        put(bytes, values->at(column.from, row.from));
  return bytes;
}

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
      for (std::vector<float>* values : {&cells.slope, &cells.aspect, &cells.elevation, &cells.soil, &cells.rule})
        (*values)[i] = reader.get<float>();
    }
}

}  // namespace gonogo::map
