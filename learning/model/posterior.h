// P(outcome | variables) of a machine, exact by free energy:
//
//   P(y | v) proportional to exp(d_y + sum_j log(1 + exp(c_j + v W_j + U_yj)))     (Larochelle & Bengio 2008, eq. 2)
//
// v is the smooth code of the known variables (Encoder::encode_smooth), so that probabilities are continuous in them.
// Unknown variables are summed over their code words: with a prior for the inputs under
//   P(x, y) = prod_v prior_v(x_v) P(y | x),
// without one under the machine's joint distribution.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/model/products/outcome_products.h"
#include "learning/model/products/single_products.h"
#include "learning/model/weights.h"

namespace gonogo::learning {

/// Independent prior probabilities of bins: [variable][bin], each variable sums to 1. When a design draws the inputs,
/// its distribution is the right prior; a machine trained for P(outcome | variables) does not learn it.
using InputPrior = std::vector<std::vector<double>>;

/// Uniform between a variable's ends: bins in proportion to their widths; equal categories.
InputPrior uniform_prior(const VisibleLayout& layout);

struct PosteriorAnswer {
  std::vector<double> probability;     // [outcome count], sums to 1
  std::vector<double> standard_error;  // [outcome count], 0 when exact
  bool exact = true;
};

struct MarginalOptions {
  std::size_t max_terms = 200'000;  // exact sum up to this many combinations of code words of the unknown variables
  // Beyond max_terms: with a prior, chains x sweeps independent draws from it. With the machine's joint distribution,
  // block Gibbs with the known units clamped, in parallel tempering over `rungs` inverse temperatures from 0 to 1 (one
  // rung: no tempering).
  std::size_t chains = 64, sweeps = 400, burn_in = 50, rungs = 4;
  std::uint64_t seed = 1;
};

/// Distribution of one unknown variable.
struct UnknownVariable {
  std::vector<double> probability, standard_error;  // [bin]; standard errors 0 when exact
  // [unit of the variable], probability spread evenly over each bin; of categories, on their values
  double mean = 0, deviation = 0;
  double low = 0, high = 0;  // 5 % and 95 % quantiles
};
struct JointAnswer {
  std::vector<UnknownVariable> variables;  // [variable count]; empty for known and fixed ones
  PosteriorAnswer outcome;                 // probability 1 for a given outcome
  bool exact = true;
};

/// Values of two variables in every combination.
struct VariableGrid {
  std::size_t first = 0, second = 1;  // variables
  std::span<const double> first_values, second_values;
};

/// A grid with what all points on it share; see Posterior::prepared(). The grid's values must outlive it.
struct PreparedGrid {
  VariableGrid grid;
  std::vector<double> lowest, highest;                          // least and most field of both variables [hidden count]
  std::vector<double> first_field = {}, second_field = {};      // [value x hidden count]
  std::vector<double> first_inverse = {}, second_inverse = {};  // exp(-field), the second one in lanes
  bool fits = true;                                             // no factor leaves the range of double
};

/// Bound on the estimated error of interpolated probabilities; see Posterior::on_grid().
inline constexpr double kGridError = 1e-5;

class Posterior {
 public:
  /// Empty `prior`: the machine's joint distribution. Throws InputError for a prior that does not match the layout.
  Posterior(const VisibleLayout& layout, const RbmWeights& weights, const InputPrior& prior = {});

  /// For known variables. variables: [variable count], no NaN; result: [outcome count].
  void operator()(std::span<const double> variables, std::span<double> result) const;

  /// Unknown variables are NaN.
  PosteriorAnswer marginal(std::span<const double> variables, const MarginalOptions& options = {}) const;

  /// P(outcome) at every node of a grid over two known variables. `variables`: the other ones; those of the grid are
  /// ignored. result: [first value][second value][outcome]. With all others known the answers are those of
  /// operator() but for rounding. Where some are unknown, sums are taken at few nodes between the middles of bins and
  /// interpolated; the error is estimated to stay below kGridError (docs/map.md).
  void on_grid(std::span<const double> variables, const VariableGrid& grid, std::span<double> result) const {
    on_prepared(variables, prepared(grid), result);
  }
  /// The same for many points on one grid.
  void on_prepared(std::span<const double> variables, const PreparedGrid& prepared, std::span<double> result) const;
  PreparedGrid prepared(const VariableGrid& grid) const;

  /// P(each unknown variable | known ones), and of the outcome, which may be known.
  JointAnswer joint(std::span<const double> variables, std::optional<std::size_t> outcome,
                    const MarginalOptions& options = {}) const;

  std::size_t outcome_count() const { return outcome_bias_.size(); }

 private:
  struct Nodes {                     // one variable: contributions of each bin's code word
    std::vector<double> middle;      // [bin count] middles of the bins [unit of the variable]
    std::vector<double> half;        // [bin count] half of their widths; 0 of categories
    std::vector<double> field;       // [bin count x hidden count]
    std::vector<double> bias;        // [bin count]: visible biases of the code word, or the log of the prior
    std::vector<double> inverse;     // exp(-field)
    std::vector<double> log_weight;  // the largest 0; see prepare_products()
    bool smooth = true;              // interpolated between middles; false for categories
    std::size_t unit_count = 0;
  };
  void add_field(const Nodes& nodes, double x, std::span<double> field) const;
  /// Log of the unnormalised probability of every outcome, with hidden units summed out.
  void scores(std::span<const double> field, std::span<double> result) const;
  /// Sum over all combinations of bins of the unknown variables. sum_products() is several times faster, and returns
  /// nothing when a product could overflow a double .
  PosteriorAnswer sum_logarithms(const std::vector<double>& field, const std::vector<std::size_t>& unknown) const;
  static constexpr std::size_t kLanes = OutcomeProducts::kLanes;
  void prepare_products();
  /// Least and greatest field of every hidden unit over all combinations of the unknown variables.
  struct FieldRange {
    std::vector<double> lowest, highest;  // [hidden count]
    double size = 0;                      // greatest sum of sizes of its parts
  };
  FieldRange field_range(std::span<const double> field, const std::vector<std::size_t>& unknown) const;
  bool products_fit(std::span<const double> field, const std::vector<std::size_t>& unknown) const;
  template <class Real>
  struct LaneBlocks;  // posterior_parts.h
  template <class Real, std::size_t kCount>
  LaneBlocks<Real> lane_blocks(const std::vector<std::size_t>& unknown) const;
  /// How sum_products() goes through the combinations of the unknown variables: the same for all known values.
  struct Summation;  // posterior_parts.h
  Summation summation(const std::vector<std::size_t>& unknown) const;
  /// add(inverse, weight) for every combination of the outer variables: exp(-field) with these set, and their weight.
  template <class Add>
  void visit_outer(std::span<const double> field, const Summation& plan, Add&& add) const;
  std::vector<double> outcome_products(std::span<const double> field, const Summation& plan) const;
  /// The same in single precision; nothing where that has not the range.
  std::optional<std::vector<double>> single_products(std::span<const double> field, const Summation& plan) const;
  enum class Precision { full, single };  // single: where it is near enough for kGridError
  std::optional<PosteriorAnswer> sum_products(std::span<const double> field, const Summation& plan,
                                              Precision precision = Precision::full) const;
  void known_on_grid(std::span<const double> field, const PreparedGrid& prepared, std::span<double> result) const;
  std::vector<std::size_t> bin_counts(const std::vector<std::size_t>& variables) const;
  /// visit(field, bias) for every combination of bins of the unknown variables; bias: the sum of theirs.
  template <class Visit>
  void visit_combinations(const std::vector<double>& field, const std::vector<std::size_t>& unknown,
                          Visit&& visit) const;
  struct Question;  // posterior_parts.h
  Question question(std::span<const double> variables, std::optional<std::size_t> outcome) const;
  JointAnswer joint_sum(const Question& asked) const;
  JointAnswer joint_sample(const Question& asked, const MarginalOptions& options) const;
  struct DrawnSums;  // joint.cpp
  /// P(outcome) of up to kLanes combinations. bins: [lane][unknown variable]; result: [lane][outcome].
  void outcome_shares(const Question& asked, bool in_products, std::span<const std::size_t> bins,
                      std::span<double> result) const;
  void draw_group(const Question& asked, const std::vector<std::vector<double>>& prior, const MarginalOptions& options,
                  std::size_t g, DrawnSums& sums) const;
  JointAnswer joint_drawn(const Question& asked, const MarginalOptions& options) const;
  void take_prior(const InputPrior& prior);
  /// P(outcome | all variables) from the fields of the hidden units.
  void outcome_shares(std::span<const double> field, std::span<double> result) const;
  class TemperedChain;
  JointAnswer finish(const Question& asked, JointAnswer answer) const;

  std::vector<Nodes> nodes_;
  std::vector<double> hidden_bias_;
  std::vector<double> outcome_bias_;    // d [outcome count]
  std::vector<double> outcome_weight_;  // U [outcome count x hidden count]
  std::vector<double> outcome_factor_;  // exp(U)
  double largest_outcome_weight_ = 0;
  OutcomeProducts products_;
  SingleProducts single_products_;
  bool has_prior_ = false;
};

}  // namespace gonogo::learning
