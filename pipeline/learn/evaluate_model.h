// A model against trials it was not trained on.
#pragma once
#include <filesystem>

#include "base/json/json.h"

namespace gonogo::pipeline {

/// Scores of P(go) on the valid trials of `dataset` whose point was not trained on, beside logistic regression and the
/// base rate of the model's own training trials:
/// { "trials", "left_out_unknown", "left_out_trained_on", "outcome_log_loss_nat", "scores": {...} }.
/// Throws InputError when no trial is left to score.
Json evaluate_model(const std::filesystem::path& model, const std::filesystem::path& dataset);

}  // namespace gonogo::pipeline
