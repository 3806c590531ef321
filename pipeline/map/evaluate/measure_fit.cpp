#include "pipeline/map/evaluate/measure_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/campaign/study/contract.h"

namespace gonogo::map {
namespace {

constexpr std::size_t kFewestTrials = 12;

/// Symmetric positive definite matrix, n x n.
struct Normal {
  std::size_t n;
  std::vector<double> value;
  double& at(std::size_t i, std::size_t j) { return value[i * n + j]; }
};

/// Inverse by Gauss-Jordan without pivoting, which such a matrix does not need.
Normal inverse_of(Normal a) {
  Normal b{a.n, std::vector<double>(a.n * a.n, 0.0)};
  for (std::size_t i = 0; i < a.n; ++i) b.at(i, i) = 1;
  for (std::size_t k = 0; k < a.n; ++k) {
    const double pivot = a.at(k, k);
    for (std::size_t j = 0; j < a.n; ++j) a.at(k, j) /= pivot, b.at(k, j) /= pivot;
    for (std::size_t i = 0; i < a.n; ++i) {
      if (i == k) continue;
      const double factor = a.at(i, k);
      for (std::size_t j = 0; j < a.n; ++j) a.at(i, j) -= factor * a.at(k, j), b.at(i, j) -= factor * b.at(k, j);
    }
  }
  return b;
}

struct Rows {
  std::size_t count = 0, features = 0;
  std::vector<double> feature;        // [count x features], the first one is 1
  std::vector<double> value;          // [count]
  std::vector<std::size_t> variable;  // that vary, in the order of their pairs of features
  const double* row(std::size_t i) const { return &feature[i * features]; }
};

struct Solution {
  std::vector<double> coefficient;
  double leave_one_out = std::numeric_limits<double>::infinity();  // rmse
};

double dot(const double* a, const double* b, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/// Ridge on all features but the constant. A residual left out is r / (1 - h), h its leverage.
Solution ridge(const Rows& rows, double strength) {
  const std::size_t n = rows.features;
  Normal normal{n, std::vector<double>(n * n, 0.0)};
  std::vector<double> right(n, 0.0);
  for (std::size_t i = 0; i < rows.count; ++i)
    for (std::size_t a = 0; a < n; ++a) {
      right[a] += rows.row(i)[a] * rows.value[i];
      for (std::size_t b = 0; b < n; ++b) normal.at(a, b) += rows.row(i)[a] * rows.row(i)[b];
    }
  for (std::size_t a = 1; a < n; ++a) normal.at(a, a) += strength * double(rows.count);
  const Normal inverse = inverse_of(normal);
  Solution solution;
  for (std::size_t a = 0; a < n; ++a) solution.coefficient.push_back(dot(&inverse.value[a * n], right.data(), n));
  double sum = 0;
  for (std::size_t i = 0; i < rows.count; ++i) {
    double leverage = 0;
    for (std::size_t a = 0; a < n; ++a) leverage += rows.row(i)[a] * dot(&inverse.value[a * n], rows.row(i), n);
    const double left_out =
        (rows.value[i] - dot(rows.row(i), solution.coefficient.data(), n)) / std::max(1e-9, 1 - leverage);
    sum += left_out * left_out;
  }
  solution.leave_one_out = std::sqrt(sum / double(rows.count));
  return solution;
}

/// Scaling of the variables, and the means that stand in for unknown ones.
void scale(MeasureFit& fit, std::span<const double> points, const std::vector<std::size_t>& kept, std::size_t width) {
  fit.middle.assign(width, 0.0);
  fit.half_width = fit.linear = fit.quadratic = fit.mean_z = fit.mean_z2 = fit.middle;
  for (std::size_t v = 0; v < width; ++v) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::size_t i : kept) {
      low = std::min(low, points[i * width + v]);
      high = std::max(high, points[i * width + v]);
    }
    fit.middle[v] = (low + high) / 2;
    fit.half_width[v] = high > low ? (high - low) / 2 : 0;
    if (!(fit.half_width[v] > 0)) continue;
    for (const std::size_t i : kept) {
      const double z = (points[i * width + v] - fit.middle[v]) / fit.half_width[v];
      fit.mean_z[v] += z / double(kept.size());
      fit.mean_z2[v] += z * z / double(kept.size());
    }
  }
}

Rows make_rows(const MeasureFit& fit, std::span<const double> points, std::span<const double> value,
               const std::vector<std::size_t>& kept) {
  const std::size_t width = fit.middle.size();
  Rows rows;
  for (std::size_t v = 0; v < width; ++v)
    if (fit.half_width[v] > 0) rows.variable.push_back(v);
  rows.count = kept.size();
  rows.features = 1 + 2 * rows.variable.size();
  for (const std::size_t i : kept) {
    rows.feature.push_back(1);
    for (const std::size_t v : rows.variable) {
      const double z = (points[i * width + v] - fit.middle[v]) / fit.half_width[v];
      rows.feature.push_back(z);
      rows.feature.push_back(z * z);
    }
    rows.value.push_back(value[i]);
  }
  return rows;
}

void describe_values(MeasureFit& fit, const Rows& rows) {
  double mean = 0, square = 0;
  for (const double x : rows.value) mean += x / double(rows.count);
  for (const double x : rows.value) square += (x - mean) * (x - mean) / double(rows.count);
  fit.constant = mean;
  fit.spread = std::sqrt(square);
  fit.error = fit.spread * double(rows.count) / std::max(1.0, double(rows.count) - 1);  // of the mean, left out
  fit.lowest = *std::min_element(rows.value.begin(), rows.value.end());
  fit.highest = *std::max_element(rows.value.begin(), rows.value.end());
}

}  // namespace

double MeasureFit::value(std::span<const double> variables) const {
  double sum = constant;
  for (std::size_t v = 0; v < middle.size(); ++v) {
    if (!(half_width[v] > 0)) continue;
    const bool known = !std::isnan(variables[v]);
    const double z = (variables[v] - middle[v]) / half_width[v];
    sum += linear[v] * (known ? z : mean_z[v]) + quadratic[v] * (known ? z * z : mean_z2[v]);
  }
  return sum;
}

MeasureFit fit_measure(std::string name, std::string unit, std::span<const double> points,
                       std::span<const double> value) {
  const std::size_t width = campaign::contract().variables.size();
  MeasureFit fit;
  fit.name = std::move(name);
  fit.unit = std::move(unit);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < value.size(); ++i)
    if (std::isfinite(value[i])) kept.push_back(i);
  fit.trials = kept.size();
  fit.middle.assign(width, 0.0);
  fit.half_width = fit.linear = fit.quadratic = fit.mean_z = fit.mean_z2 = fit.middle;
  if (kept.empty()) return fit;
  scale(fit, points, kept, width);
  const Rows rows = make_rows(fit, points, value, kept);
  describe_values(fit, rows);
  if (kept.size() < kFewestTrials) return fit;
  Solution best;
  for (const double strength : {1e-3, 1e-2, 0.1, 1.0}) {
    Solution solution = ridge(rows, strength);
    if (solution.leave_one_out < best.leave_one_out) best = std::move(solution);
  }
  if (!(best.leave_one_out < fit.error)) return fit;
  fit.error = best.leave_one_out;
  fit.constant = best.coefficient[0];
  for (std::size_t k = 0; k < rows.variable.size(); ++k) {
    fit.linear[rows.variable[k]] = best.coefficient[1 + 2 * k];
    fit.quadratic[rows.variable[k]] = best.coefficient[2 + 2 * k];
  }
  return fit;
}

double SlopeMeasure::at(BedSlopes s) const {
  const double value = base + s.along * (along + along2 * s.along) + s.across * (across + across2 * s.across);
  return std::clamp(value, lowest, highest);
}

SlopeMeasure on_soil(const MeasureFit& fit, const std::vector<std::vector<double>>& points) {
  const std::size_t a = campaign::contract().variable_index("slope_along"),
                    b = campaign::contract().variable_index("slope_across");
  SlopeMeasure measure;
  for (std::vector<double> point : points) {
    point[a] = 0;
    point[b] = 0;
    measure.base += fit.value(point) / double(points.size());
  }
  // l (x - m) / w + q (x - m)^2 / w^2 as a polynomial in x, whose constant is in `base` already.
  const auto expand = [&fit](std::size_t v, double& first, double& second) {
    if (!(fit.half_width[v] > 0)) return;
    const double w = fit.half_width[v];
    first = fit.linear[v] / w - 2 * fit.quadratic[v] * fit.middle[v] / (w * w);
    second = fit.quadratic[v] / (w * w);
  };
  expand(a, measure.along, measure.along2);
  expand(b, measure.across, measure.across2);
  measure.lowest = fit.lowest;
  measure.highest = fit.highest;
  return measure;
}

}  // namespace gonogo::map
