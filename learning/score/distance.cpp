#include "learning/score/distance.h"

#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"

namespace gonogo::learning {
namespace {

double total_variation(const ScoredRows& a, const ScoredRows& b, std::size_t first, std::size_t second) {
  std::map<std::pair<double, double>, double> cell;  // share in a less share in b
  const auto count = [&](const ScoredRows& rows, double sign) {
    const double total = std::accumulate(rows.weight.begin(), rows.weight.end(), 0.0);
    for (std::size_t n = 0; n < rows.count(); ++n)
      cell[{rows.row(n)[first], rows.row(n)[second]}] += sign * rows.weight[n] / total;
  };
  count(a, 1);
  count(b, -1);
  double sum = 0;
  for (const auto& [place, difference] : cell) sum += std::abs(difference) / 2;
  return sum;
}

void add(TableDistance& result, double distance, std::size_t first, std::size_t second, double share) {
  result.mean += distance * share;
  if (distance <= result.largest) return;
  result.largest = distance;
  result.largest_a = first;
  result.largest_b = second;
}

}  // namespace

TableDistance marginal_distance(const ScoredRows& a, const ScoredRows& b) {
  GONOGO_ASSERT(a.columns == b.columns);
  TableDistance result;
  for (std::size_t c = 0; c < a.columns; ++c) add(result, total_variation(a, b, c, c), c, c, 1 / double(a.columns));
  return result;
}

TableDistance pair_distance(const ScoredRows& a, const ScoredRows& b) {
  GONOGO_ASSERT(a.columns == b.columns);
  TableDistance result;
  const double pairs = double(a.columns) * double(a.columns - 1) / 2;
  for (std::size_t c = 0; c < a.columns; ++c)
    for (std::size_t d = c + 1; d < a.columns; ++d) add(result, total_variation(a, b, c, d), c, d, 1 / pairs);
  return result;
}

}  // namespace gonogo::learning
