// Eight chains at once, side by side in the lanes of vector registers: the sweeps of Spins, several times faster. A
// lane's bits do not depend on its neighbours'.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/sampler/spins.h"

namespace gonogo::learning {

inline constexpr int kLanes = 8;

/// Eight numbers on which arithmetic acts lane by lane (vector types of GCC and Clang).
template <class T>
struct LaneType {
  typedef T type __attribute__((vector_size(kLanes * sizeof(T))));
};
template <class T>
using Lanes = typename LaneType<T>::type;

/// Draws of eight chains with following numbers: those of ChainRandom.
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

/// Probability that a spin turns. Both keep exp(-beta E); Metropolis turns more often and cools faster, heat bath also
/// mixes where turns cost nothing.
enum class TurnRule {
  heat_bath,  // 1 / (1 + exp(beta dE))
  metropolis  // min(1, exp(-beta dE))
};

/// States of eight chains with their local fields f_i = h_i + sum_j J_ij s_j in numbers of type Real.
template <class Real>
class SpinLanes {
 public:
  explicit SpinLanes(const SpinGraph& graph);
  /// Fair bits from units 0 ... of the row that `random` stands at.
  void randomise(LaneRandom& random);
  /// Spin after spin turns as the rule says, dE = -2 s_i f_i.
  void sweep(double beta, TurnRule rule, LaneRandom& random);
  /// Sums the fields anew, which takes off the rounding that turns have added to them.
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

/// Whether numbers of 24 bits hold every exponent beta dE of this graph to 1e-4.
bool single_precision_holds(const SpinGraph& graph, double beta);

}  // namespace gonogo::learning
