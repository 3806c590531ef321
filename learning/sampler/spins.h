// Spins on a sparse graph and one sweep over them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"
#include "learning/sampler/chain_random.h"

namespace gonogo::learning {

/// E(s) = sum_i h_i s_i + sum J_ij s_i s_j. Neighbours of spin i: neighbour[first[i]] ... neighbour[first[i + 1] - 1].
struct SpinGraph {
  explicit SpinGraph(const Problem& ising);
  std::size_t size() const { return h.size(); }
  std::vector<double> h, J;
  std::vector<std::uint32_t> first, neighbour;
};

/// One state with its local fields f_i = h_i + sum_j J_ij s_j.
class Spins {
 public:
  explicit Spins(const SpinGraph& graph) : graph_(&graph), s_(graph.size(), 1) { refresh(); }
  /// Sets fair bits from units 0 ... of the present row of `random`.
  void randomise(ChainRandom& random);
  /// Heat bath, spin by spin: s_i = +1 with probability 1 / (1 + exp(2 beta f_i)). Uses random units 0 ... size - 1.
  void sweep(double beta, ChainRandom& random);
  void flip(std::uint32_t i);
  double energy() const;  // without the problem's offset
  std::span<const std::int8_t> values() const { return s_; }

 private:
  void refresh();
  const SpinGraph* graph_;
  std::vector<std::int8_t> s_;
  std::vector<double> field_;
};

/// Rows to be filled, for `reads` reads of a problem, with occurrences 1.
SampleSet empty_rows(const Problem& problem, std::size_t reads);
/// Sets row r to these spins, in the problem's vartype, and its energy.
void set_row(SampleSet& rows, std::size_t r, const Problem& problem, std::span<const std::int8_t> spins);

}  // namespace gonogo::learning
