// Which inputs matter: from any function of them, and from how much worse its answers get without one.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gonogo::learn {

/// points [count x dimensions], row by row -> [count]
using ManyValues = std::function<void(std::span<const double> points, std::span<double> values)>;

struct InputBox {
  std::vector<double> minimum, maximum;  // [dimensions]
};

struct TotalIndices {
  double variance = 0;        // of the function over the box
  std::vector<double> total;  // [dimensions] share of the variance that is gone when all other inputs are known,
                              // interactions included; 0 where the variance is
};

/// Sobol' total indices over a box in which every point is as likely: M. J. W. Jansen, "Analysis of variance designs
/// for model output" (1999), S_T,j = mean (f(A) - f(A with column j of B))^2 / (2 variance), with A and B the first and
/// last columns of a scrambled Sobol' sequence of `samples` points. Needs 2 dimensions <= 21; throws InputError beyond.
TotalIndices sobol_total_indices(const ManyValues& function, const InputBox& box, std::uint32_t samples,
                                 std::uint64_t seed);

/// Increase of the mean squared error of `function` at `points` [count x dimensions] against `truth` [count] when
/// one column is shuffled, mean over `repeats` shuffles (L. Breiman, "Random forests", 2001, section 10). [dimensions]
std::vector<double> permutation_importance(const ManyValues& function, std::span<const double> points,
                                           std::size_t dimensions, std::span<const double> truth, int repeats,
                                           std::uint64_t seed);

}  // namespace gonogo::learn
