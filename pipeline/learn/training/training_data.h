// Trials -> what a model is trained on.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/table.h"
#include "pipeline/campaign/trial/record.h"
#include "pipeline/learn/training/settings.h"

namespace gonogo::learn {

struct TrainingData {
  learning::TrainingTable table;           // valid trials; weight = prior / proposal, mean 1; replicates in one group
  std::size_t trials = 0, failed = 0;      // all; those that ended unknown and are left out
  std::vector<double> failed_variables;    // [failed x variable count]
  std::vector<double> lower, upper;        // [variable count]: sampled box
  std::vector<std::size_t> outcome_count;  // [outcome]: rows that ended so
};

/// The prior is uniform over the sampled box, so that a row's weight is 1 / proposal density.
/// `design` is the study's section, whose "ranges" widen the box beyond the outermost trials; without it the box is
/// what the trials span. Throws InputError when no valid trial is left.
TrainingData make_training_data(const std::vector<campaign::TrialRecord>& records, const std::optional<Config>& design);

/// Raises the weights to a power in [0, 1] and makes their mean 1 again. 1: forecasts suit the whole box, at the price
/// of few trials that count where a design put many; 0: every trial counts alike, which is better where the machine can
/// follow the outcomes anyway (Shimodaira, J. Statist. Plann. Inference 90:227, 2000).
void temper_weights(TrainingData& data, double importance);

/// Takes at least `count` valid trials out of the table, whole groups of replicates, drawn from the seed; returns them.
/// Throws InputError when fewer than two groups would be left to train on.
learning::TrainingTable hold_out(TrainingData& data, std::size_t count, std::uint64_t seed);

/// Encoders by study or contract over the sampled box; a variable that was held fixed gets no units.
learning::VisibleLayout make_layout(const TrainingData& data, const LearningSettings& settings);

/// 1 for outcomes that are go or slow_go, in the order of contract().outcomes.
std::vector<int> passable_outcomes();

}  // namespace gonogo::learn
