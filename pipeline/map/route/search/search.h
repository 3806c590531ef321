// Cheapest ways over the cells of a map, by Dijkstra's algorithm (1959).
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "pipeline/map/route/search/cost.h"

namespace gonogo::map {

/// The priority queue of Dijkstra's search: cells by the smallest cost found so far.
///
/// A buffer for boost::breadth_first_visit. A cell whose cost falls is pushed again; its older entries are dropped when
/// they reach the top. Of equal costs the lower cell number comes first.
///
/// Entries wait in buckets of costs whose bits begin alike, and only the lowest bucket is a heap (Dial 1969; Denardo
/// and Fox 1979).
class NearestFirst {
 public:
  explicit NearestFirst(const std::vector<float>& cost) : cost_(cost) {}

  bool empty() const { return lowest_ == bucket_.size(); }
  std::size_t top() const { return std::uint32_t(bucket_[lowest_].front()); }
  void push(std::size_t cell) {
    const std::uint64_t entry = key(cell);
    const std::size_t b = entry >> (32 + kBitsOfBucket);
    if (empty() || b < lowest_) lowest_ = b;
    if (b >= bucket_.size()) bucket_.resize(b + 1);
    bucket_[b].push_back(entry);
    if (b == lowest_) std::push_heap(bucket_[b].begin(), bucket_[b].end(), std::greater<>());
  }
  void update(std::size_t cell) { push(cell); }
  void pop() {
    do {
      std::pop_heap(bucket_[lowest_].begin(), bucket_[lowest_].end(), std::greater<>());
      bucket_[lowest_].pop_back();
      if (bucket_[lowest_].empty()) begin_next_bucket();
    } while (!empty() && overtaken(bucket_[lowest_].front()));
  }

 private:
  static constexpr int kBitsOfBucket = 13;  // of the mantissa: a bucket is a thousandth of its cost wide

  /// Bits of non-negative floats sort as the floats do, so cost and cell fit one integer.
  std::uint64_t key(std::size_t cell) const {
    return std::uint64_t(std::bit_cast<std::uint32_t>(cost_[cell])) << 32 | std::uint32_t(cell);
  }
  bool overtaken(std::uint64_t entry) const { return entry != key(std::uint32_t(entry)); }

  void begin_next_bucket() {
    do {
      bucket_[lowest_] = {};
      while (++lowest_ < bucket_.size() && bucket_[lowest_].empty()) {
      }
      if (empty()) return;
      std::erase_if(bucket_[lowest_], [&](std::uint64_t entry) { return overtaken(entry); });
    } while (bucket_[lowest_].empty());
    std::make_heap(bucket_[lowest_].begin(), bucket_[lowest_].end(), std::greater<>());
  }

  const std::vector<float>& cost_;
  std::vector<std::vector<std::uint64_t>> bucket_;
  std::size_t lowest_ = 0;  // bucket that holds the top; bucket_.size(): there is none
};

/// Cheapest ways over the cells of a map, by Dijkstra's algorithm (1959).
/// In place of the cell to reach: every one.
inline constexpr std::size_t kAnywhere = std::size_t(-1);

struct FoundRoute {
  double cost = 0;
  std::vector<std::uint32_t> cell;  // from start to end, neighbours of each other
};

/// The cheapest way from `start` to `end`; nothing if there is none. Ties are broken by cell number, so the result is
/// always the same.
std::optional<FoundRoute> find_route(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                     std::uint32_t end);

/// Min cost from `start` to every cell [cell]; with `backwards`, from every cell to `start`. No way: infinity.
std::vector<float> reach(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start, bool backwards = false);

/// Number of the connected region of each cell [cell]; -1 if no heading passes. Two neighbours are connected if `costs`
/// allows the steps in both directions. Regions are numbered in the order of their first cell.
std::vector<std::int32_t> connected_regions(const RouteCells& cells, const RouteCosts& costs);

}  // namespace gonogo::map
