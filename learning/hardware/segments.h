// Unbroken parts of the lines of a graph, and which of them cross.
#pragma once
#include <vector>

#include "learning/hardware/graph.h"

namespace gonogo::learning {

struct Segment {
  std::size_t line = 0;
  std::vector<Qubit> qubits;  // end to end
};

/// Maximal runs of working, coupled qubits of every line of direction u.
std::vector<Segment> segments(const HardwareGraph& graph, int u);

/// Whether a coupler joins segment a of `vertical` and segment b of `horizontal`: [a][b].
std::vector<std::vector<char>> crossings(const HardwareGraph& graph, const std::vector<Segment>& vertical,
                                         const std::vector<Segment>& horizontal);

/// Number of couplers between each pair of chains that has one; which chain each qubit belongs to.
class ChainCouplers {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  ChainCouplers(const HardwareGraph& graph, const std::vector<std::vector<Qubit>>& chains);
  /// No pair of chains loses its last coupler when q leaves its chain.
  bool can_spare(Qubit q) const;
  void remove(Qubit q);
  /// q joins a chain; so far it belongs to none.
  void add(Qubit q, std::uint32_t chain);
  std::uint32_t owner(Qubit q) const { return owner_[q]; }  // kNone: no chain's
  bool coupled(std::size_t a, std::size_t b) const { return count_[a * chain_count_ + b] > 0; }

 private:
  std::uint32_t& count(std::uint32_t a, std::uint32_t b) { return count_[std::size_t(a) * chain_count_ + b]; }
  const HardwareGraph& graph_;
  std::size_t chain_count_;
  std::vector<std::uint32_t> owner_;
  std::vector<std::uint32_t> count_;  // [chain x chain]
};

}  // namespace gonogo::learning
