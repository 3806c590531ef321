// How much each input of a function matters: Sobol' indices, and the loss of accuracy when an input is shuffled.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gonogo::learn {

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

}  // namespace gonogo::learn
