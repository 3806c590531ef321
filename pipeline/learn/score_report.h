// Scores of P(go) beside the baselines, as one report.
#pragma once
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::pipeline {

/// Forecasts for the same trials by the model, logistic regression and the base rate, and what happened (1: passable).
struct Forecasts {
  std::vector<double> model, logistic, base_rate;  // [trial]
  std::vector<int> happened;                       // [trial]
};

/// { "model": {...}, "logistic_regression": {...}, "base_rate": {...} }, each as learning::score_report makes it.
Json score_forecasts(const Forecasts& forecasts, std::uint64_t seed);

/// The table of scores and the reliability of the model for people.
std::string scores_text(const Json& scores);

}  // namespace gonogo::pipeline
