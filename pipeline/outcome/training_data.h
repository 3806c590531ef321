// Turns trials into the table that a model is trained on.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/model/model.h"
#include "learning/training.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/setup/record.h"
#include "pipeline/outcome/settings.h"

namespace gonogo::outcome {

struct TrainingData {
  /// Valid trials. Weight: prior / proposal, mean 1; a group holds replicates; margin: mean speed over the commanded
  /// one.
  learning::TrainingTable table;
  std::size_t trials = 0, failed = 0;      // number of all; of those that ended unknown, which are left out
  std::vector<double> failed_variables;    // [failed x variable count]
  std::vector<double> lower, upper;        // [variable count]: sampled box
  std::vector<std::size_t> outcome_count;  // [outcome] number of rows
};

/// The prior is uniform over the sampled box, so a row's weight is proportional to 1 / proposal density. The box is
/// what the trials span; "ranges" of the study's section `design` widen it. Throws InputError if no trial is valid or a
/// proposal density is not positive.
TrainingData make_training_data(const std::vector<campaign::TrialRecord>& records, const std::optional<Config>& design);

/// Widens the box to the ranges of the study that the dataset holds: its trials were drawn from them.
void widen_to_own_ranges(TrainingData& data, const campaign::Provenance& provenance, const std::string& where);

/// Raises the weights to the power `importance` in [0, 1] and scales their mean to 1. With 1, forecasts fit the whole
/// box, but regions with many trials count little. With 0, all trials count alike. That is better if the machine can
/// represent the outcomes everywhere (Shimodaira, J. Statist. Plann. Inference 90:227, 2000).
void temper_weights(TrainingData& data, double importance);

/// Moves at least `count` valid trials from the table to the held-out set, which it returns. Groups of replicates stay
/// together; the seed draws them. Throws InputError if fewer than two groups would be left.
learning::TrainingTable hold_out(TrainingData& data, std::size_t count, std::uint64_t seed);

/// Groups of `count` rows together, or a few more where the last one has replicates, drawn by the seed. Ascending; all
/// groups where the table has fewer rows.
std::vector<std::uint64_t> drawn_groups(const learning::TrainingTable& table, std::size_t count, std::uint64_t seed);

/// Leaves the rows of these groups in the table.
void keep_groups(TrainingData& data, const std::vector<std::uint64_t>& groups);

/// Units of the machine. Encoders come from the study or the contract, over the sampled box. A variable that was held
/// fixed gets no units.
learning::VisibleLayout make_layout(const TrainingData& data, const LearningSettings& settings);

/// Fills the parts of a model with a layout that describe its trials and the prior of its inputs.
void describe_trials(const TrainingData& data, bool uniform_inputs, learning::Model& model);

/// Variables that trials had at more than one value: those with units.
std::vector<std::size_t> varying_inputs(const learning::VisibleLayout& layout);

/// 1 for go and slow_go, 0 for no_go, in the order of contract().outcomes [outcome count].
std::vector<int> passable_outcomes();

/// The same of every row of the table [rows].
std::vector<int> passable_labels(const learning::TrainingTable& table);

}  // namespace gonogo::outcome
