// Unnormalised probabilities of all outcomes as products over the hidden units, for several points at once.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace gonogo::learning {

/// With f_j the field of hidden unit j, and biases d and weights U of the outcomes,
///
///   exp(d_y) prod_j (1 + exp(f_j + U_yj)) = prod_j exp(f_j)  *  exp(d_y) prod_j (exp(-f_j) + exp(U_yj))
///
/// The first factor is the same for all outcomes. operator() computes the second one, without an exponential: the
/// exp(-f_j) of a point are products of what its variables give.
class OutcomeProducts {
 public:
  static constexpr std::size_t kLanes = 8;           // points at once
  static constexpr std::size_t kOutcomesAtOnce = 5;  // their products of all lanes fit in 10 of 16 vector registers

  OutcomeProducts() = default;
  /// outcome_bias: d [outcome count]; outcome_weight: U [outcome count x hidden count].
  OutcomeProducts(std::span<const double> outcome_bias, std::span<const double> outcome_weight);

  /// inverse: exp(-f) [hidden count x kLanes]; product: [padded_outcomes() x kLanes], 0 beyond the outcomes.
  void operator()(std::span<const double> inverse, std::span<double> product) const;
  /// The same where the points share a part of exp(-f). common: that part [hidden count]; inverse: the other one.
  void operator()(std::span<const double> common, std::span<const double> inverse, std::span<double> product) const;

  /// Weighted sums over many points, kept by lane until the end.
  struct Sum {
    explicit Sum(const OutcomeProducts& products) : product(products.padded_outcomes() * kLanes), weighted(product) {}
    std::vector<double> product;   // of the points added last
    std::vector<double> weighted;  // [padded_outcomes() x kLanes]
  };
  /// Adds the products of kLanes points, times their weights [kLanes]; common and inverse as above. normalised:
  /// products are first divided by their sum over the outcomes.
  void add(std::span<const double> common, std::span<const double> inverse, std::span<const double> weight,
           bool normalised, Sum& sum) const;

  std::size_t padded_outcomes() const { return base_.size(); }

  /// Whether all products stay inside exp(-range) ... exp(range) on their way, where lowest[j] <= f_j <= highest[j].
  bool fit(std::span<const double> lowest, std::span<const double> highest, double range) const;

 private:
  template <bool kShared>
  void multiply(const double* common, std::span<const double> inverse, std::span<double> product) const;

  std::vector<double> base_;    // exp(d), the largest 1 [padded_outcomes()], 0 beyond the outcomes
  std::vector<double> factor_;  // exp(U) [group of outcomes][hidden count][kOutcomesAtOnce], 0 beyond the outcomes
  std::vector<double> least_, most_;  // least and largest U_yj over the outcomes [hidden count]
  double bias_range_ = 0;             // largest minus least d
};

}  // namespace gonogo::learning
