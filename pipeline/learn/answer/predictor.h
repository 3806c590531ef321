// What a trained model says about a point: P(outcome | variables), exact over the outcomes; and whether the point lies
// where trials were simulated at all.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/model/model.h"
#include "learning/model/posterior.h"

namespace gonogo::learn {

/// Probabilities for points given as variables in the order and units of contract().variables; not-a-number marks an
/// unknown variable, which is summed out over the model's prior of inputs, or over the machine's own joint distribution
/// where it has none. Variables that the study held fixed carry no information: any value gives the same probabilities
/// (inside_sampled_box() says whether it was the fixed one). Thread-safe; same bits for any number of threads and any
/// batch size.
class Predictor {
 public:
  /// Throws InputError for a file that is missing, truncated, not a model, or made under another contract.
  static Predictor read(const std::filesystem::path& model_file);
  explicit Predictor(learning::Model model);

  /// [contract().outcomes.size()], in that order; sums to 1.
  std::vector<double> outcome_probabilities(std::span<const double> variables) const;
  /// The same with its standard error, which is above 0 when so many variables are unknown that they had to be sampled.
  learning::PosteriorAnswer marginal(std::span<const double> variables,
                                     const learning::MarginalOptions& options = {}) const;
  /// What every unknown variable may be, and the outcome, which may be given: P(any | any subset). Variables are told
  /// by the machine alone; a calibration of outcomes does not touch them.
  learning::JointAnswer reconstruct(std::span<const double> variables, std::optional<std::size_t> outcome) const;
  /// P(go or slow_go | a valid trial).
  double p_go(std::span<const double> variables) const;
  double p_go(std::span<const double> variables, const learning::MarginalOptions& options) const;

  /// Many points at once, on all threads. points: [point_count x variable count], row by row; result: [point_count] and
  /// [point_count x outcome count].
  void p_go(std::span<const double> points, std::span<double> result) const;
  void outcome_probabilities(std::span<const double> points, std::span<double> result) const;

  /// Every known variable lies within the range that trials sampled (held-fixed ones: equals the fixed value).
  bool inside_sampled_box(std::span<const double> variables) const;
  /// Name of the first variable outside its sampled range, or "".
  std::string outside_variable(std::span<const double> variables) const;
  /// Distance to the nearest trial in units of the sampled ranges, over the known variables, divided by the median
  /// distance between neighbouring trials: about 1 where trials are as dense as on average, 0 on a trial.
  double novelty(std::span<const double> variables) const;

  const learning::Model& model() const { return *model_; }

 private:
  template <class Store>
  void for_each_point(std::span<const double> points, Store store) const;
  bool needs_summation(std::span<const double> point) const;
  learning::PosteriorAnswer calibrated(learning::PosteriorAnswer answer) const;

  std::shared_ptr<const learning::Model> model_;
  learning::Posterior posterior_;
  std::vector<double> go_weight_;  // [outcome count]: 1 for go and slow_go
  double typical_distance_ = 1;
};

}  // namespace gonogo::learn
