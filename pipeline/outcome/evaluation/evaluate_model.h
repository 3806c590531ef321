// Evaluates a model on a held-out set, trials that it was not trained on: scores, pass criteria, and their JSON, text
// and files.
#pragma once
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/evaluation/hidden_inputs.h"
#include "pipeline/outcome/evaluation/joint_scores.h"
#include "pipeline/outcome/evaluation/scores.h"

namespace gonogo::outcome {

/// Max calibration error above the floor. The floor is the error that a perfectly calibrated forecaster with the same
/// forecasts would show.
inline constexpr double kMaxCalibrationError = 0.02;
/// Number of inputs that are hidden to compare the model with mean imputation.
inline constexpr std::size_t kHiddenInputs = 2;
/// Max distance of the coverage of intervals of 90 % from 0.9.
inline constexpr double kMaxCoverageMiss = 0.03;

/// A pass criterion.
struct Criterion {
  std::string what;
  bool holds = false;
  double value = 0, limit = 0;
  double low = NAN, high = NAN;  // 95 % interval of the value; NaN without one
};

struct Evaluation {
  std::size_t trials = 0, unknown = 0, trained_on = 0;  // scored; left out: failed, and trained on
  double outcome_log_loss = 0;                          // [nat]
  Scores scores;                                        // of P(go)
  std::vector<MissingPoint> missing;
  std::optional<Reconstruction> reconstruction;
  JointScores joint;
  std::vector<Criterion> checks;
};

/// One check for each of
///
///   Brier score, log loss   difference to the best baseline by that score; holds if the interval reaches 0 or below
///   calibration error       above its floor; holds up to kMaxCalibrationError
///   two inputs hidden       Brier score minus that of each baseline with mean imputation; holds below 0
///   reconstruction        coverage within kMaxCoverageMiss of 0.9; log loss below that of the prior of the inputs
///
/// The last two are left out if too few inputs vary, or there is no reconstruction.
std::vector<Criterion> evaluation_checks(const Evaluation& evaluation);

Json to_json(const Evaluation& evaluation);
std::string checks_text(const std::vector<Criterion>& checks);
std::string evaluation_text(const Evaluation& evaluation);

/// evaluation.json with `report`, reliability.csv, missing.csv (where there is a curve) and, in a build with pictures,
/// evaluation.png. Returns the files.
std::vector<std::filesystem::path> write_evaluation(const std::filesystem::path& folder, const Json& report,
                                                    const Scores& scores, const std::vector<MissingPoint>& missing);

/// Scores P(go) on the valid trials of `dataset` whose point was not trained on. The baselines are trained on the
/// model's own training trials and scored beside it. The curve with inputs hidden leaves out the Gaussian process,
/// which takes too long for so many answers. `rows`: CSV of rows (read_given_rows()) that the joint scores take, too;
/// empty for none. Throws InputError if no trial is left to score.
Evaluation evaluate_model(const std::filesystem::path& model, const std::filesystem::path& dataset,
                          const std::filesystem::path& rows = {});
/// The same of these trials, which `where` names.
Evaluation evaluate_model(const Predictor& model, const campaign::Dataset& trials, const std::string& where,
                          const std::filesystem::path& rows = {});

/// The part of it that takes seconds: the counts, the scores of the model alone, and the joint scores.
Evaluation evaluate_joint(const std::filesystem::path& model, const std::filesystem::path& dataset,
                          const std::filesystem::path& rows = {});

}  // namespace gonogo::outcome
