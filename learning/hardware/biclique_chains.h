// Chains of visible and hidden variables on a graph, extended over unused qubits to couple more pairs. A chain that
// ends at a dead qubit can continue on pieces of other lines that dead qubits have cut off.
#pragma once
#include <vector>

#include "learning/hardware/embedding.h"
#include "learning/hardware/segments.h"

namespace gonogo::learning {

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
