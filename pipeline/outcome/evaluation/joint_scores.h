// How far rows of a model's joint distribution can be told from trials that it has not seen.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "base/json/json.h"
#include "learning/training.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/joint_summary.h"

namespace gonogo::outcome {

/// Fewest rows of either kind that are scored.
inline constexpr std::size_t kMinJointRows = 50;
/// Most rows of each kind.
inline constexpr std::size_t kMaxJointRows = 1000;

struct JointScores {
  std::string left_out;      // why there are no scores: too few rows are left
  std::size_t rows = 0;      // of each kind
  std::string sampler;       // of the machine's rows
  double largest_r_hat = 0;  // of these rows; NaN where they were drawn on their own

  struct Distance {
    double mean = 0, largest = 0;  // total variation of bins
    std::vector<std::string> of;   // columns of the largest
  };
  struct Kind {
    std::string name;
    double auc_bins = 0;       // cross-validated AUC of telling them from held-out trials, both snapped to bins
    double auc_values = 0;     // the same with values as they are; 0.5: not at all
    double trained_brier = 0;  // of P(go or slow_go) on the held-out trials, by boosted trees fitted to the rows
    Distance marginals, pairs;
  };
  std::vector<Kind> kinds;
};

/// The machine's rows against half of the trials that it was trained on, the other half being the floor. None where
/// there are too few trials.
std::optional<JointSummary> scored_joint(const Predictor& predictor, const learning::TrainingTable& trials,
                                         std::uint64_t seed);

/// Scores rows of several kinds against held-out trials, as many of each:
///
///   machine          the machine's joint distribution (sampling/sample_rows.h)
///   prior            inputs from the model's prior, the outcome from P(outcome | variables); left out without a prior
///   gaussian_copula  of the training trials, the outcome as steps of a latent variable in the contract's order
///   trials           training trials themselves: the floor
///   given            the rows given, if any
///
/// Trials weigh as in training: `held_out` has the weights prior / proposal, which are raised to the study's
/// `importance`. Rows with an unknown value are left out.
JointScores joint_scores(const Predictor& predictor, const learning::TrainingTable& trained,
                         const learning::TrainingTable& held_out, std::uint64_t seed,
                         const std::optional<learning::TrainingTable>& given = std::nullopt);
Json to_json(const JointScores& scores);
std::string joint_text(const JointScores& scores);

/// Rows of variables and outcome from a CSV file, as gonogo sample and gonogo qubo import write them. Columns by the
/// header: variables of the contract, "outcome", and "occurrences" and "weight", whose product weighs a
/// row. Variables without a column are unknown (NaN), rows of weight 0 are left out, other columns count for nothing.
/// Throws InputError for a file without an outcome or without rows, and for cells that are no number or no outcome.
learning::TrainingTable read_given_rows(const std::filesystem::path& file);

}  // namespace gonogo::outcome
