// How far rows of a model's joint distribution can be told from trials that it has not seen.
#pragma once
#include <optional>
#include <string>

#include "base/json/json.h"
#include "learning/table.h"
#include "pipeline/learn/answer/predictor.h"

namespace gonogo::learn {

/// Fewest rows of either kind that are scored.
inline constexpr std::size_t kMinJointRows = 50;
/// Most rows of each kind.
inline constexpr std::size_t kMaxJointRows = 1000;

/// Scores rows of several kinds against held-out trials, as many of each:
///
///   machine          the machine's joint distribution (sampling/sample_rows.h)
///   prior            inputs from the model's prior, the outcome from P(outcome | variables); left out without a prior
///   gaussian_copula  of the training trials, the outcome as steps of a latent variable in the contract's order
///   trials           training trials themselves: the floor
///   given            the rows given, if any
///
/// "auc_bins"   cross-validated AUC of telling them from held-out trials, values of both snapped to bins (0.5: not at
/// all) "auc_values" the same with values as they are "trained_brier"  Brier score of P(go or slow_go) on the held-out
/// trials by boosted trees fitted to the rows "marginals", "pairs"  total variation of bins: { mean, largest, of:
/// [names] }
///
/// Trials weigh as in training: `held_out` has the weights prior / proposal, which are raised to the study's
/// `importance`. Rows with an unknown value are left out. { "left_out": reason } where too few rows are left.
Json joint_scores(const Predictor& predictor, const learning::TrainingTable& trained,
                  const learning::TrainingTable& held_out, std::uint64_t seed,
                  const std::optional<learning::TrainingTable>& given = std::nullopt);
std::string joint_text(const Json& scores);

}  // namespace gonogo::learn
