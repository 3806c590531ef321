// Chains of qubits along the lines of a graph. Only inside learning/qubits.
#pragma once
#include <array>
#include <vector>

#include "learning/qubits/embedding.h"
#include "learning/qubits/graph.h"

namespace gonogo::learning {

/// Unbroken part of a line.
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

/// A vertical and a horizontal line of the same number, joined where they cross: the two arms of a chain, each from end
/// to end.
struct Cross {
  std::array<std::vector<Qubit>, 2> arm;  // vertical, horizontal
  Qubit joint[2] = {0, 0};                // the coupled qubits of the two arms
};

/// The longest cross of every number of lines that has one, in the order of lines.
std::vector<Cross> crosses(const HardwareGraph& graph);

/// Chains of visible and hidden variables on a graph, extended over unused qubits to couple more pairs. A chain that
/// ends at a dead qubit can continue on pieces of other lines that dead qubits have cut off.
class BicliqueChains {
 public:
  /// chains: visible ones first, each connected. The graph must outlive the object.
  BicliqueChains(const HardwareGraph& graph, std::size_t visible, Chains chains);
  /// Number of pairs (visible, hidden) with a coupler.
  std::size_t coupled_pairs() const;
  /// Repeatedly adds the path of unused qubits that gives a chain the most new partners, until none gives any. Chains
  /// stay within twice the length of the longest one at the start.
  void lengthen();
  /// Removes ends of chains that couple no pair on their own.
  void trim();
  const Chains& chains() const { return chains_; }
  /// Number of unused qubits visited so far, as a measure of work.
  std::size_t looks() const { return looks_; }

 private:
  struct Growth {
    std::vector<Qubit> path;     // from the chain outwards
    std::vector<Qubit> reached;  // all unused qubits that the chain can reach
    std::size_t gain = 0;        // new partners along the path
  };
  bool wanted(std::size_t a, std::size_t b) const {
    return (a < visible_) != (b < visible_) && !couplers_.coupled(a, b);
  }
  Growth best_growth(std::size_t chain);
  void grow(std::size_t chain, const Growth& growth);
  bool is_end(Qubit q) const;

  const HardwareGraph& graph_;
  std::size_t visible_;
  Chains chains_;
  ChainCouplers couplers_;
  std::size_t longest_ = 0, looks_ = 0;
};

}  // namespace gonogo::learning
