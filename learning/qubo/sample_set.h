// Answers to a problem: rows of values with their energies.
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
  std::vector<Label> labels;              // [variable_count()]
  std::vector<std::int8_t> values;        // [row_count() x variable_count()] of {0, 1} or {-1, +1}
  std::vector<double> energies;           // [row_count()]
  std::vector<std::int64_t> occurrences;  // [row_count()], at least 1
  Json info = Json::object();             // any information of the sampler

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

/// The answer in the problem's vartype and order of variables. Throws InputError when it belongs to another problem: by
/// its labels, by "problem_hash" in its info, or by its energies. Energies may differ by 1e-6 of the problem's largest
/// energy difference, because some tools compute in single precision.
SampleSet check_answer(const Problem& problem, const SampleSet& answer, const std::string& source);

}  // namespace gonogo::learning
