#include "learning/rbm/standardise.h"

namespace gonogo::learning {

Standardisation standardisation_of(const TrainingTable& table) {
  Standardisation result;
  for (std::size_t v = 0; v < table.variable_count; ++v) {
    double sum = 0, square = 0, count = 0;
    for (std::size_t n = 0; n < table.row_count(); ++n) {
      const double x = table.row(n)[v];
      if (std::isnan(x)) continue;
      sum += x;
      count += 1;
    }
    const double mean = count > 0 ? sum / count : 0;
    for (std::size_t n = 0; n < table.row_count(); ++n) {
      const double x = table.row(n)[v];
      if (!std::isnan(x)) square += (x - mean) * (x - mean);
    }
    result.mean.push_back(mean);
    result.scale.push_back(square > 0 ? std::sqrt(square / count) : 1);
  }
  return result;
}

}  // namespace gonogo::learning
