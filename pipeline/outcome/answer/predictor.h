// Answers of a trained model of this program's contract: P(outcome | variables), exact over the outcomes, and how far a
// point lies from the trials.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "base/units.h"
#include "learning/model/model.h"
#include "learning/model/posterior.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/outcome/answer/novelty.h"

namespace gonogo::outcome {

/// Reads a model. Variables of tasks (pipeline/campaign/study/contract.h) that it lacks are added: 0 in all its
/// trials, without units. Throws InputError for a file that is missing, damaged, no model or of another contract.
learning::Model read_contract_model(const std::filesystem::path& file);

/// Throws InputError, beginning with `source`, unless variables and outcomes are the contract's.
void check_contract(const learning::Model& model, const std::string& source);

/// Gravity of the trials that a model learned from [m/s^2]; files without the key are of the Earth.
inline double gravity_of(const learning::Model& model) {
  const Json* gravity = model.provenance.find(campaign::kGravityKey);
  return gravity ? gravity->number() : kGravity;
}

/// A point holds the variables in the order and units of contract().variables. NaN marks an unknown variable. It is
/// summed out over the model's prior of inputs, or over the machine's joint distribution if the model has no prior.
/// Variables that the study held fixed do not change the probabilities; inside_sampled_box() compares them with the
/// fixed value. Thread-safe. The bits do not depend on the number of threads or the batch size.
class Predictor {
 public:
  /// Throws InputError for a file that is missing, truncated, no model, or made under another contract.
  static Predictor read(const std::filesystem::path& model_file);
  explicit Predictor(learning::Model model);

  /// P(outcome | variables) in the order of contract().outcomes [outcome count]; sums to 1.
  std::vector<double> outcome_probabilities(std::span<const double> variables) const;
  /// The same with its standard error. It is above 0 if too many variables are unknown to sum them out exactly, so that
  /// they are sampled.
  learning::PosteriorAnswer marginal(std::span<const double> variables,
                                     const learning::MarginalOptions& options = {}) const;
  /// Distribution of every unknown variable and of the outcome, given the known variables and, if set, the outcome.
  /// Variables come from the machine alone; the calibration of outcomes does not change them.
  learning::JointAnswer reconstruct(std::span<const double> variables, std::optional<std::size_t> outcome) const;
  /// P(go or slow_go | a valid trial).
  double p_go(std::span<const double> variables) const;
  double p_go(std::span<const double> variables, const learning::MarginalOptions& options) const;

  /// Many points at once, on all threads. points: [point_count x variable count], row by row. result: [point_count],
  /// and [point_count x outcome count].
  void p_go(std::span<const double> points, std::span<double> result) const;
  void outcome_probabilities(std::span<const double> points, std::span<double> result) const;

  /// Fills `answer` for a point without slopes, by `compute` or from memory.
  using SlopeSums = std::function<void(std::span<const double> point, std::span<double> answer,
                                       const std::function<void(std::span<double>)>& compute)>;
  /// P(outcome) of many points at every pair of slopes [deg]; the slopes in `points` are ignored. result:
  /// [point][along] [across][outcome]. Unknown variables are summed out within kGridError, see
  /// learning::Posterior::on_grid(). These sums cost most, and go through `sums` if it is given.
  void on_slopes(std::span<const double> points, std::span<const double> along, std::span<const double> across,
                 std::span<double> result, const SlopeSums& sums = {}) const;

  /// Whether every known variable lies in the range that trials sampled. A variable held fixed must equal that value.
  bool inside_sampled_box(std::span<const double> variables) const;
  /// Name of the first variable outside its sampled range, or "".
  std::string outside_variable(std::span<const double> variables) const;
  /// Distance from the trials; see Novelty::of.
  double novelty(std::span<const double> variables) const { return novelty_.of(variables); }
  /// The same uphill, at slopes that rise [deg]; the slopes in `variables` are ignored.
  void novelty_uphill(std::span<const double> variables, std::span<const double> slopes,
                      std::span<double> result) const;
  /// Whether a variable that the trials varied is unknown, so that answers are sums.
  bool needs_summation(std::span<const double> point) const;

  const learning::Model& model() const { return *model_; }

 private:
  template <class Store>
  void for_each_point(std::span<const double> points, Store store) const;
  learning::PosteriorAnswer calibrated(learning::PosteriorAnswer answer) const;

  std::shared_ptr<const learning::Model> model_;
  learning::Posterior posterior_;
  std::vector<double> go_weight_;  // [outcome count]: 1 for go and slow_go
  Novelty novelty_;
};

}  // namespace gonogo::outcome
