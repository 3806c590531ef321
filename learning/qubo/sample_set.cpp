#include "learning/qubo/sample_set.h"

#include <cmath>
#include <map>
#include <sstream>

#include "base/error.h"

namespace gonogo::learning {
namespace {

/// Column of the answer that holds each variable of the problem.
std::vector<std::size_t> columns(const Problem& problem, const SampleSet& answer, const std::string& source) {
  std::map<Label, std::size_t> column;
  for (std::size_t k = 0; k < answer.labels.size(); ++k) column.emplace(answer.labels[k], k);
  if (column.size() != problem.variable_count() || answer.labels.size() != problem.variable_count())
    throw InputError(source + ": the answer has " + std::to_string(answer.labels.size()) + " variables, the problem " +
                     std::to_string(problem.variable_count()) + "; give the answer to this very problem");
  std::vector<std::size_t> result;
  for (const Label& label : problem.labels) {
    const auto found = column.find(label);
    if (found == column.end())
      throw InputError(source + ": the answer has no variable " + label_text(label) +
                       "; give the answer to this very problem");
    result.push_back(found->second);
  }
  return result;
}

void check_hash(const Problem& problem, const SampleSet& answer, const std::string& source) {
  const Json* hash = answer.info.is_object() ? answer.info.find("problem_hash") : nullptr;
  if (hash && hash->is_string() && hash->string() != problem_hash(problem))
    throw InputError(source + ": info.problem_hash: this answer was made for another problem (" + hash->string() + ")");
}

double energy_scale(const Problem& problem) {
  double scale = std::abs(problem.offset);
  for (double bias : problem.linear) scale += std::abs(bias);
  for (const Coupling& c : problem.couplings) scale += std::abs(c.value);
  return std::max(scale, 1e-300);
}

}  // namespace

SampleSet check_answer(const Problem& problem, const SampleSet& answer, const std::string& source) {
  check_hash(problem, answer, source);
  const std::vector<std::size_t> column = columns(problem, answer, source);
  SampleSet result;
  result.vartype = problem.vartype;
  result.labels = problem.labels;
  result.occurrences = answer.occurrences;
  result.info = answer.info;
  const double tolerance = 1e-6 * energy_scale(problem);
  const std::size_t n = problem.variable_count();
  for (std::size_t r = 0; r < answer.row_count(); ++r) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::int8_t value = answer.row(r)[column[i]];
      if (answer.vartype == problem.vartype)
        result.values.push_back(value);
      else
        result.values.push_back(problem.vartype == Vartype::binary ? value > 0 : (value > 0 ? 1 : -1));
    }
    const double expected = energy(problem, std::span(result.values).subspan(r * n, n));
    if (!(std::abs(expected - answer.energies[r]) <= tolerance)) {
      std::ostringstream text;
      text << source << ": row " << r << ": energy " << answer.energies[r] << " does not match the problem's "
           << expected << "; the answer is for another problem, or was scaled";
      throw InputError(text.str());
    }
    result.energies.push_back(expected);
  }
  return result;
}

}  // namespace gonogo::learning
