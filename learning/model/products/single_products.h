// P(outcome) by the products of OutcomeProducts in single precision, for sums over thousands of points that share a
// part of their fields.
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gonogo::learning {

/// Computes P(y | f) proportional to exp(d_y) prod_j (exp(-f_j) + exp(U_yj)). Each factor is divided by a middle value
/// of its hidden unit, which is the same for all outcomes and points, and products are divided by their sum over the
/// outcomes on the way, so that none leaves the range of float.
///
/// A factor comes of three roundings of exp(-f_j), one of exp(U_yj) and one of their sum, and its product is rounded
/// once: 5 u with H hidden units, u = 2^-24, so that P(y) is wrong by 2 P (1 - P) 5 H u <= 2.5 H u at most. What a sum
/// over points adds is below 32 u. error_bound() is the sum of both.
///
/// Outcomes that no trial had are alike: training leaves them weights near 0. One product stands for all of them, with
/// the middle of their weights. The product of y is e^(+-delta_y) times its share of that, delta_y being half of the
/// sum over j of |U_yj - middle_j|. So P of any outcome is wrong by P(alike) delta at most: alike_error().
class SingleProducts {
 public:
  static constexpr std::size_t kLanes = 16;          // points at once
  static constexpr std::size_t kOutcomesAtOnce = 4;  // their products of all lanes fit in 8 of 16 vector registers
  static constexpr std::size_t kMostBlocks = 24;     // of kLanes points whose shares are added in single precision

  SingleProducts() = default;
  /// outcome_bias: d [outcome count]; outcome_weight: U [outcome count x hidden count].
  SingleProducts(std::span<const double> outcome_bias, std::span<const double> outcome_weight);

  /// Bound on the error of a weighted sum of P(outcome) by rounding, where weights sum to 1.
  double error_bound() const;
  /// Bound on what alike outcomes add to it, where weights sum to 1. sum: of add().
  double alike_error(std::span<const double> sum) const;
  /// Outcomes that are told apart.
  std::size_t apart_count() const { return delta_.size(); }
  /// P of all outcomes [outcome count] from those that are told apart.
  std::vector<double> all_outcomes(std::span<const double> sum) const;

  /// Factors for points whose fields lie in a range.
  struct Scaled {
    std::vector<double> over_middle;   // 1 / a factor's middle value [hidden count]
    std::vector<float> factor;         // exp(U) times it [group of outcomes][hidden count][kOutcomesAtOnce]
    std::vector<std::size_t> until{};  // hidden units after which products are divided by their sum; the last: all
  };
  /// lowest[j] <= f_j <= highest[j]; part[j]: largest size of the part of f_j that a point does not share with others.
  /// Nothing where a factor may leave the range of float, or an outcome might vanish on the way and come back.
  std::optional<Scaled> scaled(std::span<const double> lowest, std::span<const double> highest,
                               std::span<const double> part) const;

  /// Adds weight times P(outcome) of blocks of kLanes points, kMostBlocks at most, to sum [apart_count()]. common:
  /// shared part of exp(-f) over the middle value [hidden count]; inverse: the other one [block][hidden count][lane];
  /// weight: [block][lane]; scale: factor of all weights.
  void add(const Scaled& scaled, std::span<const float> common, std::span<const float> inverse,
           std::span<const float> weight, double scale, std::span<double> sum) const;

 private:
  std::vector<std::size_t> stands_for_;  // [outcome] which of those told apart
  std::vector<double> share_;            // [outcome] of that one's P
  std::vector<double> delta_;            // [told apart] 0 of one that stands for itself alone
  std::vector<float> base_;              // exp(d), the largest 1 [padded outcomes], 0 beyond the outcomes
  std::vector<double> factor_;           // exp(U) [group of outcomes][hidden count][kOutcomesAtOnce], 0 beyond them
  std::vector<double> least_, most_;     // least and largest U_yj over the outcomes [hidden count]
  double bias_range_ = 0;                // largest minus least d
};

}  // namespace gonogo::learning
