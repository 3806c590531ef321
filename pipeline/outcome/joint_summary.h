// How good a model's joint distribution was when it was trained, as its file keeps it.
#pragma once
#include <optional>
#include <string>

#include "base/json/json.h"
#include "learning/model/model.h"

namespace gonogo::outcome {

/// Rows of the machine, and trials, each against other trials of the training set (evaluation/joint_scores.h).
struct JointSummary {
  std::size_t rows = 0;                       // of each kind
  std::size_t splits = 1;                     // pairs of halves of the trials that the scores are means over
  double auc_bins = 0, auc_values = 0;        // of telling the machine's rows from trials
  double floor_bins = 0, floor_values = 0;    // of telling trials from trials
  double trained_brier = 0, floor_brier = 0;  // on trials, of trees fitted to the machine's rows, to other trials
  double passable = 0, trials_passable = 0;   // share of go and slow_go among the machine's rows, and the trials
  /// Neither AUC exceeds its floor by more than 0.08.
  bool looks_like_the_trials() const;
  /// The share that passes differs from the trials' by at most 0.03, or the standard error of the trials' share.
  bool passes_as_the_trials() const;
};
Json to_json(const JointSummary& summary);
/// None in models that were not scored.
std::optional<JointSummary> joint_summary(const Json& provenance);
/// One sentence where the machine's joint distribution is not that of its trials; empty elsewhere.
std::string joint_warning(const learning::Model& model);

}  // namespace gonogo::outcome
