// Mean of repeated measurements and its standard error.
#pragma once
#include <cmath>
#include <vector>

namespace gonogo {

struct MeanError {
  double mean = 0, error = 0;  // standard error of the mean; 0 for one value
};

/// {0, 0} without values.
inline MeanError mean_error(const std::vector<double>& values) {
  const auto n = double(values.size());
  double mean = 0, square = 0;
  for (const double v : values) mean += v / n;
  for (const double v : values) square += (v - mean) * (v - mean);
  return {mean, n > 1 ? std::sqrt(square / (n - 1) / n) : 0};
}

}  // namespace gonogo
