// Importance of the variables for P(go) of a trained model.
#pragma once
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/learn/answer/predictor.h"

namespace gonogo::learn {

struct VariableImportance {
  std::string name;
  double total_index = 0;  // Sobol' total index of P(go) over the box that trials sampled
  double permutation = 0;  // increase of the Brier score on the dataset's valid trials when shuffled
};

/// Importance of every variable that the trials vary, most important first.
std::vector<VariableImportance> model_importance(const Predictor& predictor, const campaign::Dataset& dataset,
                                                 std::uint64_t seed = 1);

std::string to_text(const std::vector<VariableImportance>& importances);
Json to_json(const std::vector<VariableImportance>& importances);

}  // namespace gonogo::learn
