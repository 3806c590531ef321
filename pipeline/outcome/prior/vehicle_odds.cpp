#include "pipeline/outcome/prior/vehicle_odds.h"

#include <algorithm>
#include <cmath>

#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

struct ScoredTrials {
  std::vector<double> odds;  // log odds of passing by the model
  std::vector<int> passed;
};

ScoredTrials scored(const Predictor& model, const VehicleTrials& trials) {
  constexpr double kSure = 1e-6;  // no trial weighs more than this probability tells
  ScoredTrials result{std::vector<double>(trials.table.row_count()), passable_labels(trials.table)};
  model.p_go(trials.table.variables, result.odds);
  for (double& p : result.odds) {
    p = std::clamp(p, kSure, 1 - kSure);
    p = std::log(p / (1 - p));
  }
  return result;
}

}  // namespace

double fitted_shift(const Predictor& model, const std::vector<VehicleTrials>& vehicles) {
  constexpr double kMost = 10;  // [nat]
  std::vector<ScoredTrials> all;
  for (const VehicleTrials& trials : vehicles) all.push_back(scored(model, trials));
  // The log loss is convex in the shift: bisection on its slope, the share forecast less the share that passed.
  const auto slope = [&](double shift) {
    double sum = 0;
    for (const ScoredTrials& trials : all) {
      double excess = 0;
      for (std::size_t n = 0; n < trials.odds.size(); ++n)
        excess += 1 / (1 + std::exp(-trials.odds[n] - shift)) - trials.passed[n];
      sum += excess / double(trials.odds.size());
    }
    return sum;
  };
  if (all.empty()) return 0;
  double low = -kMost, high = kMost;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (slope(middle) < 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

void shift_odds(const learning::VisibleLayout& layout, double shift, double power, learning::RbmWeights& weights) {
  const std::vector<int> passable = passable_outcomes();
  for (std::size_t y = 0; y < passable.size(); ++y)
    if (passable[y]) weights.visible_bias[layout.input_unit_count() + y] += shift / power;
}

}  // namespace gonogo::outcome
