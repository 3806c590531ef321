// Answers to a problem: rows of values with their energies, and means over them.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

struct SampleSet {
  Vartype vartype = Vartype::binary;
  std::vector<Label> labels;                // [variable_count()]
  std::vector<std::int8_t> values{};        // [row_count() x variable_count()] of {0, 1} or {-1, +1}
  std::vector<double> energies{};           // [row_count()]
  std::vector<std::int64_t> occurrences{};  // [row_count()], at least 1
  Json info = Json::object();               // any information of the sampler

  std::size_t variable_count() const { return labels.size(); }
  std::size_t row_count() const { return energies.size(); }
  std::span<const std::int8_t> row(std::size_t i) const {
    return std::span(values).subspan(i * variable_count(), variable_count());
  }
  bool operator==(const SampleSet& other) const {
    return vartype == other.vartype && labels == other.labels && values == other.values && energies == other.energies &&
           occurrences == other.occurrences;
  }
};

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

/// Weighted mean of `value` [row], with a standard error that counts correlated reads. weight: [row], 0 for rows left
/// out. The standard error has three parts: the spread of weighted residuals; their integrated autocorrelation time
/// along the rows, with Sokal's window of five times itself (Sokal, "Monte Carlo methods in statistical mechanics",
/// 1997, section 3); and, with four groups or more, the spread of the groups' means where that is larger. All NaN when
/// every weight is 0.
SeriesMean series_mean(std::span<const double> value, std::span<const double> weight,
                       std::span<const std::int64_t> occurrences, const ReadOrder& order);

}  // namespace gonogo::learning
