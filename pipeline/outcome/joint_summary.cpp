#include "pipeline/outcome/joint_summary.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"

namespace gonogo::outcome {

bool JointSummary::looks_like_the_trials() const {
  constexpr double kChance = 0.08;
  return auc_bins <= floor_bins + kChance && auc_values <= floor_values + kChance;
}

bool JointSummary::passes_as_the_trials() const {
  constexpr double kChance = 0.03;
  const double trials = 2 * double(rows), p = trials_passable;
  return std::abs(passable - p) <= std::max(kChance, std::sqrt(p * (1 - p) / trials));
}

Json to_json(const JointSummary& summary) {
  return Json::Object{{"rows", summary.rows},
                      {"splits", summary.splits},
                      {"auc_bins", summary.auc_bins},
                      {"auc_values", summary.auc_values},
                      {"floor_bins", summary.floor_bins},
                      {"floor_values", summary.floor_values},
                      {"trained_brier", summary.trained_brier},
                      {"floor_brier", summary.floor_brier},
                      {"passable", summary.passable},
                      {"trials_passable", summary.trials_passable}};
}

std::optional<JointSummary> joint_summary(const Json& provenance) {
  const Json* joint = provenance.is_object() ? provenance.find("joint") : nullptr;
  if (!joint) return std::nullopt;
  const auto number = [&](const char* key) { return joint->at(key).number(); };
  return JointSummary{.rows = joint->at("rows").unsigned_integer(),
                      .splits = joint->find("splits") ? joint->at("splits").unsigned_integer() : 1,
                      .auc_bins = number("auc_bins"),
                      .auc_values = number("auc_values"),
                      .floor_bins = number("floor_bins"),
                      .floor_values = number("floor_values"),
                      .trained_brier = number("trained_brier"),
                      .floor_brier = number("floor_brier"),
                      .passable = number("passable"),
                      .trials_passable = number("trials_passable")};
}

std::string joint_warning(const learning::Model& model) {
  const std::optional<JointSummary> joint = joint_summary(model.provenance);
  if (!joint || (joint->looks_like_the_trials() && joint->passes_as_the_trials())) return "";
  const std::string how =
      joint->looks_like_the_trials()
          ? line("%.2f of its rows pass, and %.2f of the trials", joint->passable, joint->trials_passable)
          : line("trees tell its rows from trials with an AUC of %.2f, trials from trials with %.2f", joint->auc_values,
                 joint->floor_values);
  return "the machine's joint distribution is not that of its trials: " + how +
         "; take gonogo sample --from prior, or train again with the default settings";
}

}  // namespace gonogo::outcome
