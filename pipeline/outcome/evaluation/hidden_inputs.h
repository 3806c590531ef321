// Trials with some of their inputs hidden: how forecasts worsen, and how well a model tells what was hidden.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/score/score.h"
#include "learning/training.h"
#include "pipeline/outcome/answer/predictor.h"

namespace gonogo::outcome {

/// A forecaster of P(passable) for one row of variables [variable count]; NaN marks an unknown variable.
struct Forecaster {
  std::string name;
  std::function<double(std::span<const double>)> forecast;
};

struct MissingSettings {
  std::size_t max_rows = 1000;        // max rows of the table; drawn from the seed if it has more
  std::size_t max_subsets = 36;       // max subsets of each size, likewise; 36 are all pairs of nine
  std::size_t max_large_subsets = 6;  // the same for sizes above three, which take long
  std::uint64_t seed = 1;
};

/// Scores with one number of inputs hidden, as means over rows and subsets, which are the same for all forecasters.
struct MissingPoint {
  struct Scored {
    std::string name;
    double brier = 0, log_loss = 0;                            // log loss [nat]
    learning::Interval brier_difference, log_loss_difference;  // the first forecaster minus this one
  };
  std::size_t hidden = 0, subsets = 0, trials = 0;
  std::vector<Scored> scored;  // in the order of the forecasters; the first has no differences
};

/// Scores every forecaster with 0, 1, ... of the `hideable` variables hidden. `happened`: 1 for passable [row].
std::vector<MissingPoint> missing_curve(const std::vector<Forecaster>& forecasters,
                                        const learning::TrainingTable& table, std::span<const int> happened,
                                        const std::vector<std::size_t>& hideable, const MissingSettings& settings = {});
Json to_json(const std::vector<MissingPoint>& curve);
/// The curve as a table for people: model, baselines, and the model minus each baseline.
std::string missing_text(const std::vector<MissingPoint>& curve);

struct ReconstructionSettings {
  std::size_t max_rows = 250;  // drawn by the seed
  std::uint64_t seed = 1;
};

/// Scores of hidden values, with intervals of 95 % by bootstrap over rows.
struct Reconstruction {
  std::string left_out;  // why there is no score: fewer than two inputs vary, or no row is whole
  std::size_t rows = 0, pairs = 0;
  learning::Interval coverage{};  // share of the hidden values that lie in their interval of 90 % (low to high)
  /// Mean of log p(value) by the model minus that by the prior of the inputs, per hidden value [nat]. Both densities
  /// are constant in a bin.
  learning::Interval gain{};
  struct Variable {
    std::string name;
    double coverage = 0, gain = 0;
  };
  std::vector<Variable> variables;
};

/// Hides every pair of inputs that the trials varied, of each of the rows, and asks Predictor::reconstruct() for both,
/// given the outcome and the other inputs. Rows with an unknown input are left out.
Reconstruction reconstruction_scores(const Predictor& predictor, const learning::TrainingTable& table,
                                     const ReconstructionSettings& settings = {});
Json to_json(const Reconstruction& scores);
std::string reconstruction_text(const Reconstruction& scores);

}  // namespace gonogo::outcome
