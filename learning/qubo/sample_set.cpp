#include "learning/qubo/sample_set.h"

#include <algorithm>
#include <cmath>

namespace gonogo::learning {
namespace {

constexpr double kWindow = 5;             // of the autocorrelation times summed over
constexpr std::size_t kFewestGroups = 4;  // fewer say little about their spread

/// 1 + 2 sum of autocorrelations of a series of mean 0, up to the window; at least 1.
double correlation_time(std::span<const double> x) {
  double variance = 0;
  for (double e : x) variance += e * e;
  if (variance == 0) return 1;
  double time = 1;
  for (std::size_t lag = 1; lag < x.size() / 4 && double(lag) < kWindow * time; ++lag) {
    double sum = 0;
    for (std::size_t k = lag; k < x.size(); ++k) sum += x[k] * x[k - lag];
    time = std::max(1.0, time + 2 * sum / variance);
  }
  return time;
}

/// Variance of the mean of residuals of mean 0, from the means of equal groups.
double variance_of_groups(std::span<const double> residual, std::size_t groups) {
  const std::size_t size = residual.size() / groups;
  double square = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    double sum = 0;
    for (double e : residual.subspan(g * size, size)) sum += e;
    square += sum / double(size) * sum / double(size);
  }
  return square / double(groups) / double(groups - 1);
}

}  // namespace

SeriesMean series_mean(std::span<const double> value, std::span<const double> weight,
                       std::span<const std::int64_t> occurrences, const ReadOrder& order) {
  double reads = 0, total = 0, square = 0, sum = 0;
  for (std::size_t r = 0; r < value.size(); ++r) {
    const double count = double(occurrences[r]);
    reads += count;
    total += count * weight[r];
    square += count * weight[r] * weight[r];
    if (weight[r] > 0) sum += count * weight[r] * value[r];
  }
  SeriesMean result{.mean = sum / total, .standard_error = NAN, .correlation_time = 1, .independent_reads = 0};
  if (!(total > 0)) return result;
  std::vector<double> residual;
  double variance = 0;
  for (std::size_t r = 0; r < value.size(); ++r) {
    const double e = weight[r] > 0 ? weight[r] * (value[r] - result.mean) * reads / total : 0;
    residual.push_back(e);
    variance += double(occurrences[r]) * e * e / reads;
  }
  const bool single = std::all_of(occurrences.begin(), occurrences.end(), [](std::int64_t c) { return c == 1; });
  if (single && order.as_drawn) result.correlation_time = correlation_time(residual);
  double of_mean = variance * result.correlation_time / reads;
  if (single && order.groups >= kFewestGroups && residual.size() % order.groups == 0)
    of_mean = std::max(of_mean, variance_of_groups(residual, order.groups));
  result.standard_error = std::sqrt(of_mean);
  result.independent_reads = total * total / square / result.correlation_time;
  return result;
}

}  // namespace gonogo::learning
