// Trials with a known answer: P(go) is logistic in three of seven variables, the other four say nothing. The no-go
// trials fail for one of two reasons, by a further draw; seven outcomes never happen.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "base/math/random.h"
#include "learning/encoding/layout.h"
#include "learning/training.h"

namespace gonogo::learning {

inline constexpr std::size_t kBoundaryVariables = 7;

/// slope 0..35, cross slope -15..15, friction angle 20..45, and four that do not matter on 0..1.
inline std::vector<std::pair<double, double>> boundary_ranges() {
  return {{0, 35}, {-15, 15}, {20, 45}, {0, 1}, {0, 1}, {0, 1}, {0, 1}};
}

/// Two truths. `straight`: P(go) falls with slope, rises with friction angle, falls with variable 3. `curved`: a
/// steeper edge that a cross slope to either side brings down, which no logistic regression on the inputs can follow.
enum class Boundary { straight, curved };

inline double true_p_go(std::span<const double> x, Boundary boundary = Boundary::straight) {
  const double logit = boundary == Boundary::straight ? 0.28 * (x[0] - 17.5) - 0.14 * (x[2] - 32.5) + 2.0 * (x[3] - 0.5)
                                                      : 0.6 * (x[0] - 20 - 0.5 * (x[2] - 32.5) + 0.06 * x[1] * x[1]);
  return 1 / (1 + std::exp(logit));
}

inline TrainingTable boundary_table(std::size_t rows, std::uint64_t seed, Boundary boundary = Boundary::straight) {
  TrainingTable table;
  table.variable_count = kBoundaryVariables;
  const auto ranges = boundary_ranges();
  for (std::size_t n = 0; n < rows; ++n) {
    std::vector<double> x;
    for (std::size_t v = 0; v < kBoundaryVariables; ++v)
      x.push_back(ranges[v].first + (ranges[v].second - ranges[v].first) * random_unit(seed, n, v));
    table.variables.insert(table.variables.end(), x.begin(), x.end());
    const bool go = random_unit(seed, n, 100) < true_p_go(x, boundary);
    const bool slid = random_unit(seed, n, 101) < x[0] / 35;
    table.outcome.push_back(go ? 0 : slid ? 4 : 7);
    table.weight.push_back(1);
    table.group.push_back(n);
  }
  return table;
}

inline VisibleLayout boundary_layout() {
  const int bins[kBoundaryVariables] = {11, 7, 9, 7, 5, 5, 5};
  const auto ranges = boundary_ranges();
  std::vector<Encoder> encoders;
  for (std::size_t v = 0; v < kBoundaryVariables; ++v)
    encoders.push_back(
        Encoder::by_range("x" + std::to_string(v), "-", Code::thermometer, bins[v], ranges[v].first, ranges[v].second));
  return VisibleLayout(std::move(encoders), {"go", "slow_go", "no_go/a", "no_go/b", "no_go/c", "no_go/d", "no_go/e",
                                             "no_go/f", "no_go/g", "no_go/h"});
}

/// 1 for go and slow_go, 0 for the others [rows].
inline std::vector<int> labels_of(const TrainingTable& table) {
  std::vector<int> label;
  for (std::size_t y : table.outcome) label.push_back(y < 2);
  return label;
}

}  // namespace gonogo::learning
