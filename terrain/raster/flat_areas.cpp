#include "terrain/raster/flat_areas.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gonogo::terrain {
namespace {

constexpr int kShortest = 4;             // run [cells]
constexpr std::uint64_t kCells = 400;    // of an area
constexpr double kHectare = 1e4;         // [m2]
constexpr double kOfWholeNumbers = 1e6;  // [m2]
constexpr double kLowerShare = 0.05;     // of all borders

int root_of(std::vector<int>& parent, int node) {
  while (parent[std::size_t(node)] != node)
    node = parent[std::size_t(node)] = parent[std::size_t(parent[std::size_t(node)])];
  return node;
}

}  // namespace

std::vector<FlatAreas::Run> FlatAreas::runs_in(const std::vector<float>& row) const {
  std::vector<Run> runs;
  for (int begin = 0; begin < columns_;) {
    const float value = row[std::size_t(begin)];
    int end = begin + 1;
    while (end < columns_ && row[std::size_t(end)] == value) ++end;
    if (end - begin >= kShortest) runs.push_back({begin, end, 0});
    begin = end;
  }
  return runs;
}

/// Gives every run its area: those of touching runs above with the same height become one.
void FlatAreas::join(std::vector<Run>& runs, const std::vector<float>& row) {
  const int before = int(areas_.size());
  std::vector<int> parent(areas_.size() + runs.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t a = 0, b = 0; a < open_.size() && b < runs.size();) {
    const Run &up = open_[a], &down = runs[b];
    if (std::max(up.begin, down.begin) < std::min(up.end, down.end) &&
        above_[std::size_t(up.begin)] == row[std::size_t(down.begin)])
      parent[std::size_t(root_of(parent, up.area))] = root_of(parent, before + int(b));
    ++(up.end < down.end ? a : b);
  }
  std::vector<Area> next;
  std::vector<int> place(parent.size(), -1);  // of a root in `next`
  for (std::size_t b = 0; b < runs.size(); ++b) {
    int& at = place[std::size_t(root_of(parent, before + int(b)))];
    if (at < 0) {
      at = int(next.size());
      next.push_back({.value = row[std::size_t(runs[b].begin)]});
    }
    runs[b].area = at;
    next[std::size_t(at)].cells += std::uint64_t(runs[b].end - runs[b].begin);
    next[std::size_t(at)].runs.push_back({row_, runs[b].begin, runs[b].end});
  }
  for (int a = 0; a < before; ++a) {
    Area& old = areas_[std::size_t(a)];
    const int at = place[std::size_t(root_of(parent, a))];
    if (at < 0) {
      retire(std::move(old));
      continue;
    }
    Area& into = next[std::size_t(at)];
    if (old.runs.size() > into.runs.size()) std::swap(old.runs, into.runs);
    into.runs.insert(into.runs.end(), old.runs.begin(), old.runs.end());
    into.cells += old.cells;
    into.higher += old.higher;
    into.lower += old.lower;
  }
  areas_ = std::move(next);
}

void FlatAreas::count_borders(const std::vector<Run>& runs, const std::vector<float>& own,
                              const std::vector<float>& other) {
  for (const Run& run : runs) {
    Area& area = areas_[std::size_t(run.area)];
    const float value = own[std::size_t(run.begin)];
    for (int c = run.begin; c < run.end; ++c) {
      area.higher += other[std::size_t(c)] > value;
      area.lower += other[std::size_t(c)] < value;
    }
  }
}

void FlatAreas::count_ends(const std::vector<Run>& runs, const std::vector<float>& own) {
  for (const Run& run : runs) {
    Area& area = areas_[std::size_t(run.area)];
    for (const int beside : {run.begin - 1, run.end}) {
      if (beside < 0 || beside >= columns_) continue;
      area.higher += own[std::size_t(beside)] > area.value;
      area.lower += own[std::size_t(beside)] < area.value;
    }
  }
}

void FlatAreas::take(const std::vector<float>& row) {
  for (const float v : row) whole_numbers_ = whole_numbers_ && (std::isnan(v) || v == std::floor(v));
  std::vector<Run> runs = runs_in(row);
  if (row_ > 0) count_borders(open_, above_, row);
  join(runs, row);
  if (row_ > 0) count_borders(runs, row, above_);
  count_ends(runs, row);
  open_ = std::move(runs);
  above_ = row;
  ++row_;
}

void FlatAreas::retire(Area&& area) {
  if (area.cells >= kCells && double(area.cells) * cell_area_ >= kHectare) large_.push_back(std::move(area));
}

void FlatAreas::finish(int rows, HeightScan& scan) {
  for (Area& area : areas_) retire(std::move(area));
  for (const Area& area : large_) {
    const bool on_a_plain = double(area.lower) > kLowerShare * double(area.lower + area.higher);
    if (whole_numbers_ && (double(area.cells) * cell_area_ < kOfWholeNumbers || on_a_plain)) continue;
    scan.flat.resize(std::size_t(rows));
    for (const auto& [row, begin, end] : area.runs) scan.flat[std::size_t(row)].emplace_back(begin, end);
    ++scan.flat_areas;
    scan.flat_cells += area.cells;
  }
  for (auto& runs : scan.flat) std::sort(runs.begin(), runs.end());
}

}  // namespace gonogo::terrain
