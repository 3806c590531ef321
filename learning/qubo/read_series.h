// Means over the reads of an answer, with standard errors that count correlated reads.
#pragma once
#include <cstdint>
#include <span>

namespace gonogo::learning {

/// What the order of an answer's rows says about how they were drawn.
struct ReadOrder {
  bool as_drawn = true;    // false: sorted or counted, so neighbours say nothing
  std::size_t groups = 0;  // equal consecutive parts that share an error, as the programmings of a device do; 0: none
};

struct SeriesMean {
  double mean = 0, standard_error = 0;
  double correlation_time = 1;   // reads that count as one, at least 1
  double independent_reads = 0;  // reads of equal weight and without correlation that the answer is worth
};

/// Weighted mean of `value` [row]. weight: [row], 0 for rows left out. The standard error has three parts: the spread
/// of weighted residuals; their integrated autocorrelation time along the rows, with Sokal's window of five times
/// itself (Sokal, "Monte Carlo methods in statistical mechanics", 1997, section 3); and, with four groups or more, the
/// spread of the groups' means where that is larger. All NaN when every weight is 0.
SeriesMean series_mean(std::span<const double> value, std::span<const double> weight,
                       std::span<const std::int64_t> occurrences, const ReadOrder& order);

}  // namespace gonogo::learning
