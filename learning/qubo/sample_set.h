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
  Json info = Json::object();             // whatever the sampler tells about itself

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

/// The answer in the problem's vartype and order of variables. Throws InputError when the answer belongs to another
/// problem: other labels, another "problem_hash" in its info, or energies that differ from the problem's by more than
/// 1e-6 of the largest energy difference the problem can make (answers travel through single-precision tools).
SampleSet check_answer(const Problem& problem, const SampleSet& answer, const std::string& source);

}  // namespace gonogo::learning
