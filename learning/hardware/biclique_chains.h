// Chains of visible and hidden variables on a graph, and what unused qubits can do for pairs without a coupler: a chain
// that ends at a dead qubit goes on over pieces of other lines that dead qubits cut off from their chains.
#pragma once
#include <vector>

#include "learning/hardware/embedding.h"
#include "learning/hardware/segments.h"

namespace gonogo::learning {

class BicliqueChains {
 public:
  /// chains: the visible ones first, each connected. The graph must outlive this.
  BicliqueChains(const HardwareGraph& graph, std::size_t visible, Chains chains);
  /// Pairs (visible, hidden) with a coupler.
  std::size_t coupled_pairs() const;
  /// Adds the path of unused qubits that gives a chain most new partners, until no path gives any. No chain gets more
  /// than twice as long as the longest one was at the start.
  void lengthen();
  /// Takes off ends that couple to nobody who is not coupled elsewhere.
  void trim();
  const Chains& chains() const { return chains_; }
  /// Unused qubits that the chains have looked at so far: the work done.
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
