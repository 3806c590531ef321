// P(outcome | variables) of a machine, exact over the outcomes by free energy:
//
//   P(y | v) proportional to exp(d_y + sum_j log(1 + exp(c_j + v W_j + U_yj)))     (Larochelle & Bengio 2008, eq. 2)
//
// v is the smooth code of the known variables (Encoder::encode_smooth), so that probabilities are continuous in them.
// Unknown variables are summed out over their valid code words, under the machine's own joint distribution.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/model/weights.h"

namespace gonogo::learning {

struct PosteriorAnswer {
  std::vector<double> probability;     // [outcome count], sums to 1
  std::vector<double> standard_error;  // [outcome count], 0 when exact
  bool exact = true;
};

struct MarginalOptions {
  std::size_t most_terms = 200'000;  // sum exactly up to this many combinations of code words of the unknown variables
  std::size_t chains = 64, sweeps = 400, burn_in = 50;  // beyond that: block Gibbs with the known variables clamped
  std::uint64_t seed = 1;
};

class Posterior {
 public:
  Posterior(const VisibleLayout& layout, const RbmWeights& weights);

  /// All variables known. variables: [variable count], no not-a-number; result: [outcome count].
  void operator()(std::span<const double> variables, std::span<double> result) const;

  /// Unknown variables are not-a-number.
  PosteriorAnswer marginal(std::span<const double> variables, const MarginalOptions& options = {}) const;

  std::size_t outcome_count() const { return outcome_bias_.size(); }

 private:
  struct Nodes {                 // one variable: what each bin adds when its code word is on the visible units
    std::vector<double> middle;  // [bin count] middles of the bins [unit of the variable]
    std::vector<double> field;   // [bin count x hidden count]
    std::vector<double> bias;    // [bin count]: visible biases of the code word
    bool smooth = true;          // numbers are interpolated between middles, categories are not
    std::size_t unit_count = 0;
  };
  void add_field(const Nodes& nodes, double x, std::span<double> field) const;
  /// log of the unnormalised probability of every outcome, hidden units summed out.
  void scores(std::span<const double> field, std::span<double> result) const;
  PosteriorAnswer sum_out(std::vector<double> field, const std::vector<std::size_t>& unknown) const;
  PosteriorAnswer sample_out(const std::vector<double>& field, const std::vector<std::size_t>& unknown,
                             const MarginalOptions& options) const;
  std::vector<double> chain_mean(const std::vector<double>& field, const std::vector<std::size_t>& unknown,
                                 const MarginalOptions& options, std::size_t chain) const;

  std::vector<Nodes> nodes_;
  std::vector<double> hidden_bias_;
  std::vector<double> outcome_bias_;    // d [outcome count]
  std::vector<double> outcome_weight_;  // U [outcome count x hidden count]
  std::vector<double> outcome_factor_;  // exp(U)
  double largest_outcome_weight_ = 0;
};

}  // namespace gonogo::learning
