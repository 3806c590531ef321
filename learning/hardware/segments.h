// Unbroken segments of the lines of a graph, their crossings, and couplers between chains.
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

/// [a][b]: whether a coupler joins segment a of `vertical` and segment b of `horizontal`.
std::vector<std::vector<char>> crossings(const HardwareGraph& graph, const std::vector<Segment>& vertical,
                                         const std::vector<Segment>& horizontal);

/// Number of couplers between each pair of chains, and the chain of each qubit, while chains grow and shrink.
class ChainCouplers {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  ChainCouplers(const HardwareGraph& graph, const std::vector<std::vector<Qubit>>& chains);
  /// True when no pair of chains loses its last coupler if q leaves its chain.
  bool can_spare(Qubit q) const;
  void remove(Qubit q);
  /// Adds q, which must be free, to a chain.
  void add(Qubit q, std::uint32_t chain);
  std::uint32_t owner(Qubit q) const { return owner_[q]; }  // kNone: free
  bool coupled(std::size_t a, std::size_t b) const { return count_[a * chain_count_ + b] > 0; }

 private:
  std::uint32_t& count(std::uint32_t a, std::uint32_t b) { return count_[std::size_t(a) * chain_count_ + b]; }
  const HardwareGraph& graph_;
  std::size_t chain_count_;
  std::vector<std::uint32_t> owner_;
  std::vector<std::uint32_t> count_;  // [chain x chain]
};

}  // namespace gonogo::learning
