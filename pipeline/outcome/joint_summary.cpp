#include "pipeline/outcome/joint_summary.h"

#include "base/format.h"

namespace gonogo::outcome {

bool JointSummary::is_of_the_trials() const {
  constexpr double kChance = 0.12;
  return auc_bins <= floor_bins + kChance && auc_values <= floor_values + kChance;
}

Json to_json(const JointSummary& summary) {
  return Json::Object{{"rows", summary.rows},
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
  if (!joint || joint->is_of_the_trials()) return "";
  return line(
      "the machine's joint distribution is not that of its trials: trees tell its rows from trials with an AUC of "
      "%.2f, "
      "trials from trials with %.2f; take gonogo sample --from prior, or train again with the default settings",
      joint->auc_values, joint->floor_values);
}

}  // namespace gonogo::outcome
