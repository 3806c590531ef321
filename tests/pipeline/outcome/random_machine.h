// Machines of random weights over the variables of synthetic trials.
#pragma once
#include <string>

#include "base/math/random.h"
#include "learning/model/model.h"
#include "pipeline/outcome/training_data.h"
#include "tests/pipeline/outcome/synthetic_trials.h"

namespace gonogo::outcome {

struct RandomMachine {
  std::size_t hidden = 0;
  double size = 1;  // weights lie between -size and size
  std::string code = "thermometer";
  int units = 1;               // of each variable
  double outcome_bias = -2.5;  // one outcome unit on at a time, mostly
};

inline const TrainingData& machine_trials() {
  static const TrainingData data = make_training_data(synthetic_trials(60, 8), {});
  return data;
}

/// Without training points and prior.
inline learning::Model random_machine(const RandomMachine& machine) {
  const TrainingData& data = machine_trials();
  LearningSettings settings;
  for (const Variable& variable : contract().variables)
    settings.encoders[variable.name] = {machine.code, machine.units};
  learning::Model model;
  model.layout = make_layout(data, settings);
  model.weights = learning::RbmWeights::zeros(model.layout.unit_count(), machine.hidden);
  for (std::size_t k = 0; k < model.weights.weight.size(); ++k)
    model.weights.weight[k] = machine.size * (2 * random_unit(1, 1, k) - 1);
  for (std::size_t i = model.layout.input_unit_count(); i < model.layout.unit_count(); ++i)
    model.weights.visible_bias[i] = machine.outcome_bias;
  model.sampled_lower = data.lower;
  model.sampled_upper = data.upper;
  return model;
}

/// The trials as what the machine was trained on, and the prior that knows nothing.
inline void give_trials(learning::Model& model) {
  const TrainingData& data = machine_trials();
  model.training_points = data.table.variables;
  model.training_outcomes.assign(data.table.outcome.begin(), data.table.outcome.end());
  model.training_weights = data.table.weight;
  model.input_prior = learning::uniform_prior(model.layout);
}

}  // namespace gonogo::outcome
