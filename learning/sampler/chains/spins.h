// Spins on a sparse graph and sweeps over them: of one state, and of eight chains at once in the lanes of vector
// registers.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"
#include "learning/sampler/chains/chain_random.h"

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

inline constexpr int kLanes = 8;

/// Eight numbers with lane-wise arithmetic (vector types of GCC and Clang).
template <class T>
struct LaneType {
  typedef T type __attribute__((vector_size(kLanes * sizeof(T))));
};
template <class T>
using Lanes = typename LaneType<T>::type;

/// ChainRandom of eight chains with consecutive numbers.
class LaneRandom {
 public:
  LaneRandom(std::uint64_t seed, std::uint64_t first_chain, std::size_t units_per_row);
  void begin(std::uint64_t row);
  /// Draw `unit` of every chain: 32 random bits. unit < units_per_row.
  const Lanes<std::uint32_t>& operator()(std::size_t unit) {
    const std::uint64_t index = row_ + unit / 4;
    if (index != held_) draw(index);
    return word_[unit % 4];
  }

 private:
  void draw(std::uint64_t index);
  PhiloxKeys keys_;
  std::uint64_t first_chain_, blocks_per_row_, row_ = 0, held_ = UINT64_MAX;
  Lanes<std::uint32_t> word_[4] = {};
};

/// Probability of a spin flip. Both leave exp(-beta E) invariant. Metropolis flips more often and cools faster; heat
/// bath also mixes when flips cost no energy.
enum class TurnRule {
  heat_bath,  // 1 / (1 + exp(beta dE))
  metropolis  // min(1, exp(-beta dE))
};

/// States of eight chains with their local fields f_i = h_i + sum_j J_ij s_j, several times faster than Spins. A lane's
/// bits do not depend on the other lanes.
template <class Real>
class SpinLanes {
 public:
  explicit SpinLanes(const SpinGraph& graph);
  /// Sets fair bits from units 0 ... of the present row of `random`.
  void randomise(LaneRandom& random);
  /// Flips spins one by one by the rule, with dE = -2 s_i f_i.
  void sweep(double beta, TurnRule rule, LaneRandom& random);
  /// Recomputes the fields, which removes accumulated rounding.
  void refresh();
  /// Spins of one chain, [spin].
  void read(int lane, std::span<std::int8_t> spins) const;

 private:
  struct Row {
    Lanes<Real> of;
  };
  const SpinGraph* graph_;
  std::vector<Real> h_, J_;
  std::vector<Row> s_, field_;  // [spin]
};

/// Whether single precision holds every exponent beta dE of this graph to 1e-4.
bool single_precision_holds(const SpinGraph& graph, double beta);

}  // namespace gonogo::learning
