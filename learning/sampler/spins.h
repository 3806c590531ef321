// Spins on a sparse graph and one sweep over them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"
#include "learning/sampler/chain_random.h"

namespace gonogo::learning {

/// E(s) = sum_i h_i s_i + sum J_ij s_i s_j: neighbours of spin i are neighbour[first[i]] ... neighbour[first[i + 1] -
/// 1].
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
  /// Fair bits from units 0 ... of the row that `random` stands at.
  void randomise(ChainRandom& random);
  /// Heat bath, spin after spin: s_i = +1 with probability 1 / (1 + exp(2 beta f_i)). Draws units 0 ... size - 1.
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

/// Empty rows for `reads` reads of a problem, each read once.
SampleSet empty_rows(const Problem& problem, std::size_t reads);
/// Writes spins into row r in the problem's vartype, with the problem's energy.
void set_row(SampleSet& rows, std::size_t r, const Problem& problem, std::span<const std::int8_t> spins);

}  // namespace gonogo::learning
