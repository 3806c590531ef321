// A model against trials it was not trained on.
#pragma once
#include <filesystem>

#include "base/json/json.h"

namespace gonogo::learn {

/// Scores of P(go) on the valid trials of `dataset` whose point was not trained on, beside logistic regression, a
/// neural network and the base rate of the model's own training trials, and how all of them get worse when variables
/// are hidden: { "trials", "left_out_unknown", "left_out_trained_on", "outcome_log_loss_nat", "scores": {...},
/// "missing": [...],
/// "checks": [...] (evaluation_checks.h) }. Throws InputError when no trial is left to score.
Json evaluate_model(const std::filesystem::path& model, const std::filesystem::path& dataset);

/// Table of the missing-variable curve for people: model, baselines, and the model minus each of them.
std::string missing_text(const Json& curve);

/// evaluation.json, reliability.csv, missing.csv (where the report has a curve) and, in a build with pictures,
/// evaluation.png. Returns the files.
std::vector<std::filesystem::path> write_evaluation(const std::filesystem::path& folder, const Json& report,
                                                    const Json& scores);

}  // namespace gonogo::learn
