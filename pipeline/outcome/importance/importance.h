// How much each input of a function, or of a trained model, matters: Sobol' indices, and the loss of accuracy when an
// input is shuffled.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/answer/predictor.h"

namespace gonogo::outcome {

/// Evaluates a function. points: [count x dimensions], row by row. values: [count].
using ManyValues = std::function<void(std::span<const double> points, std::span<double> values)>;

struct InputBox {
  std::vector<double> minimum, maximum;  // [dimensions]
};

struct TotalIndices {
  double variance = 0;        // of the function over the box
  std::vector<double> total;  // [dimensions] share of the variance that involves the input, with its
                              // interactions; 0 if the variance is 0
};

/// Sobol' total indices under the uniform distribution over the box, by Jansen's estimator:
///   S_T,j = mean (f(A) - f(A with column j of B))^2 / (2 variance)
/// A and B are the first and the last columns of a scrambled Sobol' sequence of `samples` points. Throws InputError if
/// 2 dimensions > 21. M. J. W. Jansen, "Analysis of variance designs for model output" (1999).
TotalIndices sobol_total_indices(const ManyValues& function, const InputBox& box, std::uint32_t samples,
                                 std::uint64_t seed);

/// Increase of the mean squared error of `function` when one column of `points` is shuffled [dimensions], as a mean
/// over `repeats` shuffles. points: [count x dimensions], truth: [count]. L. Breiman, "Random forests" (2001),
/// section 10.
std::vector<double> permutation_importance(const ManyValues& function, std::span<const double> points,
                                           std::size_t dimensions, std::span<const double> truth, int repeats,
                                           std::uint64_t seed);

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

}  // namespace gonogo::outcome
