// The priority queue of Dijkstra's search: cells by the smallest cost found so far.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

namespace gonogo::map {

/// A buffer for boost::breadth_first_visit. A cell whose cost falls is pushed again; its older entries are dropped when
/// they reach the top. So no entry must be found inside the heap. Of equal costs the lower cell number comes first.
class NearestFirst {
 public:
  explicit NearestFirst(const std::vector<float>& cost) : cost_(cost) {}

  bool empty() const { return heap_.empty(); }
  std::size_t top() const { return std::uint32_t(heap_.front()); }
  void push(std::size_t cell) {
    heap_.push_back(key(cell));
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
  }
  void update(std::size_t cell) { push(cell); }
  void pop() {
    do {
      std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
      heap_.pop_back();
    } while (!heap_.empty() && heap_.front() != key(top()));
  }

 private:
  /// Bits of non-negative floats sort as the floats do, so cost and cell fit one integer.
  std::uint64_t key(std::size_t cell) const {
    return std::uint64_t(std::bit_cast<std::uint32_t>(cost_[cell])) << 32 | std::uint32_t(cell);
  }

  const std::vector<float>& cost_;
  std::vector<std::uint64_t> heap_;
};

}  // namespace gonogo::map
