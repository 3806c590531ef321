// The gradient of the objective (train.h) of a machine of code words, in closed form. Every known row is a mixture of
// code words, so fields are sums of the words' fields, and gradients by words add up to gradients by units. Without
// unknown variables, with
//
//   f_j = b_j + (x' W)_j,   P(y | x) ~ exp(d_y) prod_j (exp(-f_j) + exp(U_yj)),   sigmoid(f_j + U_yj) =
//   exp(U_yj) / (exp(-f_j) + exp(U_yj)),
//
// an update takes an exponential for each unit of a row instead of one for each of its outcomes, too. LibTorch's
// objective() is the reference, and serves all other machines. Only inside learning/rbm.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/machine/word_machine.h"
#include "learning/model/weights.h"
#include "learning/rbm/words/teaching.h"
#include "learning/training.h"

namespace gonogo::learning {

/// Rows as mixtures of the words of a WordMachine.
struct WordMixtures {
  std::vector<std::uint32_t> word;    // of all rows
  std::vector<double> share;          // of each word
  std::vector<std::size_t> first{0};  // words first[r] .. first[r + 1] - 1 are those of row r
  std::size_t size() const { return first.size() - 1; }
};

/// D [step x visible]: what a step from a bin to the next changes in the units. A step of a thermometer or one-hot code
/// is one unit, so that D is the identity there. Empty if it is the identity as a whole.
std::vector<double> step_rows(const VisibleLayout& layout);

class WordGradient {
 public:
  /// Whether the machine is one of code words and no row leaves a variable unknown.
  static bool serves(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings);

  /// `layout`, `table` and `settings` must outlive the object. Throws InputError for a teacher that does not fit.
  WordGradient(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
               const Teaching* teaching);

  /// Of the objective over these rows of the table, and over as many of the next points of the teacher. `words` holds
  /// `weights`; chains: rows of the machine.
  const RbmWeights& operator()(const WordMachine& words, const RbmWeights& weights, std::span<const std::size_t> rows,
                               const WordChains& chains);

 private:
  template <class Slopes>
  void add_row(const WordMixtures& rows, std::size_t row, const Slopes& slopes);
  void add_machine_rows(const WordMachine& words, const WordChains& chains);
  void add_trials(std::span<const std::size_t> rows, double trial_share);
  void add_taught(std::size_t count);
  void add_joint(std::size_t count);
  void add_complete(double slope);
  void add_prior(const RbmWeights& weights);
  void take_steps();
  void take_words(const WordMachine& words);
  void add_word(std::size_t word, double share);
  void spread(std::size_t word, double share, double slope);
  void taught_shares(double probability, std::span<const double> share, std::span<double> taught) const;
  void outcome_shares();
  void outcome_shares_by_logs();

  const VisibleLayout& layout_;
  const TrainingTable& table_;
  const TrainingSettings& settings_;
  std::size_t hidden_, padded_;               // hidden units, and rounded up to whole lanes
  std::size_t outcomes_, first_outcome_ = 0;  // the outcomes are the last words
  WordMixtures smooth_, hard_;                // of the table's rows
  // The teacher.
  double taught_weight_ = 0, joint_share_ = 0;
  WordMixtures taught_, joint_;
  std::vector<double> taught_probability_, joint_probability_;  // [point]
  std::vector<int> passes_;                                     // [outcome]
  std::size_t next_taught_ = 0, next_joint_ = 0;
  std::vector<double> step_product_;  // D' D [visible x visible]; empty: the identity
  // The machine, by words.
  std::vector<double> bias_, field_, word_bias_;  // [padded], [word x padded], [word]
  std::vector<double> odds_, outcome_bias_;       // exp(U) [outcome x padded], d [outcome]
  double largest_outcome_field_ = 0;              // |U_yj|
  // The row in work.
  std::vector<double> row_field_, inverse_, row_slope_;  // f, exp(-f), and the gradient by f [padded]
  std::vector<double> share_, slope_;                    // P(y | x) and the gradient by the outcome's score [outcome]
  // Gradients by words, then by units.
  std::vector<double> field_gradient_, bias_gradient_, hidden_gradient_;
  RbmWeights gradient_;
};

}  // namespace gonogo::learning
