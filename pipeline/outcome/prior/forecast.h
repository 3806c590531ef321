// What is known of the outcome before any own trial.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace gonogo::outcome {

/// The answers of the model of a family about one of its vehicles.
struct Forecast {
  std::string hash, about;                                                     // of the model's file; who answers
  std::size_t trials = 0;                                                      // that the model learned
  std::function<std::vector<double>(const std::vector<double>& points)> p_go;  // [point count x variables]
};

}  // namespace gonogo::outcome
