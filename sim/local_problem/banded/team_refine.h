// Residuals of a banded system and steps of iterative refinement, in double.
#pragma once
#include "sim/local_problem/banded/team_partition.h"

namespace gonogo::sim {

/// to = from times a power of two that brings it into the range of float.
template <class Scalar>
struct ScaleInto {
  View<const double> from;
  View<Scalar> to;
  double scale;

  GONOGO_HD void operator()(Index i) const { to[i] = Scalar(scale * from[i]); }
};

/// sum = x + scale step.
template <class Scalar>
struct AddStep {
  View<const double> x;
  View<const Scalar> step;
  View<double> sum;
  double scale;

  GONOGO_HD void operator()(Index i) const { sum[i] = std::fma(scale, double(step[i]), x[i]); }
};

/// Rows of which one team takes the residual.
inline constexpr Index kResidualRows = 64;

/// rest = b - A x, and of each team's rows the sum of squares and the largest size.
struct FindResidual {
  Index size, half;
  View<const double> a, b, x;
  View<double> rest, sums;  // sums: [teams][2]

  Index teams() const { return (size + kResidualRows - 1) / kResidualRows; }
  TeamShape shape() const {
    const Index numbers = kResidualRows * (2 * half + 1) + 2 * kResidualRows + 2 * half;
    return grid_for(half, 128, std::size_t(numbers) * sizeof(double));
  }
  template <class Team>
  GONOGO_HD void operator()(Team team, Index tile, double* room) const {
    const Index width = 2 * half + 1, first = tile * kResidualRows;
    const Index rows = size - first < kResidualRows ? size - first : kResidualRows;
    double *const near = room + kResidualRows * width, *const own = near + kResidualRows + 2 * half;
    for (Index q = team.rank(); q < rows * width; q += team.size()) room[q] = a[first * width + q];
    for (Index q = team.rank(); q < rows + 2 * half; q += team.size()) {
      const Index j = first - half + q;
      near[q] = j >= 0 && j < size ? x[j] : 0.0;
    }
    team.sync();
    for (Index i = team.rank(); i < rows; i += team.size()) {
      double sum = b[first + i];
      for (Index q = 0; q < width; ++q) sum = std::fma(-room[i * width + q], near[i + q], sum);
      rest[first + i] = own[i] = sum;
    }
    team.sync();
    if (team.rank() != 0) return;
    double square = 0, largest = 0;
    for (Index i = 0; i < rows; ++i) {
      square = std::fma(own[i], own[i], square);
      largest = std::fmax(largest, std::fabs(own[i]));
    }
    sums[2 * tile] = square;
    sums[2 * tile + 1] = largest;
  }
};

}  // namespace gonogo::sim
