// Evaluates a model on a held-out set: trials that it was not trained on.
#pragma once
#include <filesystem>

#include "base/json/json.h"

namespace gonogo::learn {

/// Scores P(go) on the valid trials of `dataset` whose point was not trained on. The baselines (baselines.h) are
/// trained on the model's own training trials and scored beside it. "missing" says how the scores worsen when variables
/// are hidden (missing_curve.h), without the Gaussian process, which takes too long for so many answers.
/// "reconstruction" is that of reconstruction.h, "joint" that of joint_scores.h, "checks" are those of
/// evaluation_checks.h: { "trials", "left_out_unknown", "left_out_trained_on", "outcome_log_loss_nat", "scores": {...},
/// "missing": [...],
///   "reconstruction": {...}, "joint": {...}, "checks": [...] }. `rows`: CSV of rows that "joint" scores as well
///   (given_rows.h); empty for none.
/// Throws InputError if no trial is left to score.
Json evaluate_model(const std::filesystem::path& model, const std::filesystem::path& dataset,
                    const std::filesystem::path& rows = {});

/// The part of it that takes seconds: the counts, "scores" of the model alone, and "joint".
Json evaluate_joint(const std::filesystem::path& model, const std::filesystem::path& dataset,
                    const std::filesystem::path& rows = {});

/// The missing-variable curve as a table for people: model, baselines, and the model minus each baseline.
std::string missing_text(const Json& curve);

/// evaluation.json, reliability.csv, missing.csv (where the report has a curve) and, in a build with pictures,
/// evaluation.png. Returns the files.
std::vector<std::filesystem::path> write_evaluation(const std::filesystem::path& folder, const Json& report,
                                                    const Json& scores);

}  // namespace gonogo::learn
