// What is known of the outcome before any own trial.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "learning/training.h"

namespace gonogo::outcome {

/// The answers of the teacher of a family's model about one of its vehicles.
struct Forecast {
  std::string hash, about;                                                     // of the model's file; who answers
  std::size_t trials = 0;                                                      // that the model learned
  std::function<std::vector<double>(const std::vector<double>& points)> p_go;  // [point count x variables]
  /// The family's trials, with their shares of the commanded speed as margins; no rows: they are not known.
  learning::TrainingTable table{};
  /// The points as the family's, whose variables `table` has; nothing without `table`.
  std::function<std::vector<double>(const std::vector<double>& points)> in_family{};
};

}  // namespace gonogo::outcome
