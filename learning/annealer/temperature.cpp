#include "learning/annealer/temperature.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/math/random.h"

namespace gonogo::learning {
namespace {

/// Energy that every spin of a row would gain by turning, g_i = -2 s_i (h_i + sum_j J_ij s_j): [row x spin].
std::vector<double> turning_energies(const Problem& ising, const SampleSet& rows) {
  std::vector<double> result;
  std::vector<double> field(ising.variable_count());
  for (std::size_t r = 0; r < rows.row_count(); ++r) {
    const auto s = rows.row(r);
    const auto spin = [&](std::size_t i) { return s[i] > 0 ? 1.0 : -1.0; };
    field = ising.linear;
    for (const Coupling& c : ising.couplings) {
      field[c.a] += c.value * spin(c.b);
      field[c.b] += c.value * spin(c.a);
    }
    for (std::size_t i = 0; i < field.size(); ++i) result.push_back(-2 * spin(i) * field[i]);
  }
  return result;
}

/// Derivative of a row's log pseudo-likelihood by beta, and minus the second one.
struct Slope {
  double score = 0, information = 0;
  void add(double weight, const Slope& s) {
    score += weight * s.score;
    information += weight * s.information;
  }
};
Slope slope_of(std::span<const double> g, double beta) {
  Slope slope;
  for (double x : g) {
    const double wrong = 1 / (1 + std::exp(beta * x));  // P(the spin stands the other way)
    slope.score += x * wrong;
    slope.information += x * x * wrong * (1 - wrong);
  }
  return slope;
}

/// The middle 95 % of values.
void set_interval(std::vector<double>& values, BetaEstimate& estimate) {
  std::sort(values.begin(), values.end());
  estimate.low = values[values.size() * 25 / 1000];
  estimate.high = values[values.size() - 1 - values.size() * 25 / 1000];
}

/// Weighted straight line through points; returns its slope.
double line_slope(std::span<const double> x, std::span<const double> y, std::span<const double> weight) {
  double w = 0, mx = 0, my = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    w += weight[k];
    mx += weight[k] * x[k];
    my += weight[k] * y[k];
  }
  mx /= w;
  my /= w;
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += weight[k] * (x[k] - mx) * (x[k] - mx);
    xy += weight[k] * (x[k] - mx) * (y[k] - my);
  }
  return xy / xx;
}

/// Slope of the log ratio of two histograms over equally filled bins of the pooled energies; NaN where fewer
/// than two bins hold energies of both.
double ratio_slope(const std::vector<double>& a, const std::vector<double>& b, std::size_t bins) {
  std::vector<std::pair<double, int>> pooled;
  for (double e : a) pooled.emplace_back(e, 0);
  for (double e : b) pooled.emplace_back(e, 1);
  std::sort(pooled.begin(), pooled.end());
  std::vector<double> x, y, weight;
  for (std::size_t k = 0, begin = 0; k < bins; ++k) {
    std::size_t end = pooled.size() * (k + 1) / bins;
    while (end < pooled.size() && end > begin && pooled[end].first == pooled[end - 1].first)
      ++end;  // ties stay together
    double count[2] = {0, 0}, sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      count[pooled[i].second] += 1;
      sum += pooled[i].first;
    }
    if (count[0] > 0 && count[1] > 0) {
      x.push_back(sum / double(end - begin));
      y.push_back(std::log(count[0] / count[1]));
      weight.push_back(1 / (1 / count[0] + 1 / count[1]));
    }
    begin = std::max(begin, end);
  }
  return x.size() < 2 ? NAN : line_slope(x, y, weight);
}

std::vector<double> resampled(std::span<const double> values, std::uint64_t seed, std::uint64_t stream) {
  std::vector<double> result;
  for (std::size_t k = 0; k < values.size(); ++k)
    result.push_back(values[std::size_t(random_unit(seed, stream, k) * double(values.size()))]);
  return result;
}

}  // namespace

BetaEstimate pseudo_likelihood_beta(const Problem& problem, const SampleSet& rows, std::uint64_t seed,
                                    std::span<const double> weight, std::size_t draws) {
  if (rows.row_count() == 0) throw InputError("temperature: there are no rows to estimate it from");
  const std::size_t n = problem.variable_count();
  const std::vector<double> g = turning_energies(to_ising(problem), rows);
  std::vector<double> w(weight.begin(), weight.end());
  if (w.empty()) w.assign(rows.occurrences.begin(), rows.occurrences.end());
  const auto total = [&](double beta) {
    Slope sum;
    for (std::size_t r = 0; r < rows.row_count(); ++r) sum.add(w[r], slope_of(std::span(g).subspan(r * n, n), beta));
    return sum;
  };
  if (*std::min_element(g.begin(), g.end()) >= 0) return {INFINITY, INFINITY, INFINITY};  // no spin would gain
  double low = -1, high = 1;
  while (total(low).score < 0 && low > -1e9) low *= 2;
  while (total(high).score > 0 && high < 1e9) high *= 2;
  for (int step = 0; step < 200 && high - low > 1e-15 * std::abs(high); ++step) {
    const double middle = (low + high) / 2;
    (total(middle).score > 0 ? low : high) = middle;
  }
  BetaEstimate estimate{(low + high) / 2, 0, 0};
  std::vector<Slope> of_read;
  for (std::size_t r = 0; r < rows.row_count(); ++r)
    of_read.insert(of_read.end(), std::size_t(rows.occurrences[r]),
                   slope_of(std::span(g).subspan(r * n, n), estimate.beta));
  std::vector<double> values;
  for (std::size_t d = 0; d < draws; ++d) {
    Slope sum;
    for (std::size_t k = 0; k < of_read.size(); ++k)
      sum.add(1, of_read[std::size_t(random_unit(seed, d, k) * double(of_read.size()))]);
    values.push_back(estimate.beta + sum.score / sum.information);
  }
  set_interval(values, estimate);
  return estimate;
}

BetaEstimate histogram_beta(std::span<const double> energies, double scale, std::span<const double> other_energies,
                            double other_scale, std::uint64_t seed, std::size_t bins, std::size_t draws) {
  if (scale == other_scale) throw InputError("temperature: histograms of two different scales are needed");
  const auto estimate = [&](const std::vector<double>& a, const std::vector<double>& b) {
    return -ratio_slope(a, b, bins) / (scale - other_scale);
  };
  BetaEstimate result{estimate({energies.begin(), energies.end()}, {other_energies.begin(), other_energies.end()}), 0,
                      0};
  if (std::isnan(result.beta))
    throw InputError("temperature: the two energy histograms do not overlap; take scales that are closer");
  std::vector<double> values;
  for (std::size_t d = 0; d < draws; ++d) {
    const double value = estimate(resampled(energies, seed, 2 * d), resampled(other_energies, seed, 2 * d + 1));
    if (!std::isnan(value)) values.push_back(value);
  }
  set_interval(values, result);
  return result;
}

OffsetModel fit_offset_model(std::span<const double> scale, std::span<const double> temperature,
                             std::span<const double> error) {
  GONOGO_ASSERT(scale.size() == temperature.size() && scale.size() == error.size());
  std::vector<double> x, weight;
  for (std::size_t k = 0; k < scale.size(); ++k) {
    x.push_back(1 / scale[k]);
    weight.push_back(1 / (error[k] * error[k]));
  }
  if (x.empty() || *std::max_element(x.begin(), x.end()) == *std::min_element(x.begin(), x.end()))
    throw InputError("temperature: the model with an offset needs rows at two different scales");
  OffsetModel model;
  model.slope = line_slope(x, temperature, weight);
  double sum = 0, total = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    sum += weight[k] * (temperature[k] - model.slope * x[k]);
    total += weight[k];
  }
  model.offset = sum / total;
  return model;
}

}  // namespace gonogo::learning
