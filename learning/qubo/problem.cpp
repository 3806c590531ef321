#include "learning/qubo/problem.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "learning/qubo/json.h"

namespace gonogo::learning {

std::string vartype_name(Vartype vartype) { return vartype == Vartype::binary ? "BINARY" : "SPIN"; }

std::partial_ordering LabelTuple::operator<=>(const LabelTuple& other) const { return parts <=> other.parts; }
bool LabelTuple::operator==(const LabelTuple& other) const { return parts == other.parts; }

std::string label_text(const Label& label) {
  if (const auto* number = std::get_if<std::int64_t>(&label)) return std::to_string(*number);
  if (const auto* number = std::get_if<double>(&label)) return python_number(*number);
  if (const auto* text = std::get_if<std::string>(&label)) return *text;
  const std::vector<Label>& parts = std::get<LabelTuple>(label).parts;
  std::string text;
  for (const Label& part : parts) {
    const bool quoted = std::holds_alternative<std::string>(part);
    text += (text.empty() ? "" : ", ") + (quoted ? "'" + label_text(part) + "'" : label_text(part));
  }
  return "(" + text + (parts.size() == 1 ? ",)" : ")");
}

void sort_couplings(std::vector<Coupling>& couplings) {
  std::stable_sort(couplings.begin(), couplings.end(),
                   [](const Coupling& x, const Coupling& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
}

void check_problem(const Problem& problem, const std::string& source) {
  const std::size_t n = problem.variable_count();
  if (problem.labels.size() != n)
    throw InputError(source + ": " + std::to_string(problem.labels.size()) + " labels for " + std::to_string(n) +
                     " linear biases; there must be one each");
  std::set<Label> seen;
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(problem.linear[i]))
      throw InputError(source + ": linear bias of " + label_text(problem.labels[i]) + " is not a finite number");
    if (!seen.insert(problem.labels[i]).second)
      throw InputError(source + ": label " + label_text(problem.labels[i]) + " is used twice");
  }
  if (!std::isfinite(problem.offset)) throw InputError(source + ": the offset is not a finite number");
  for (std::size_t k = 0; k < problem.couplings.size(); ++k) {
    const Coupling& c = problem.couplings[k];
    const std::string where = source + ": coupling " + std::to_string(k) + ": ";
    if (c.b >= n || c.a >= c.b)
      throw InputError(where + "variables " + std::to_string(c.a) + " and " + std::to_string(c.b) +
                       " must be two different ones below " + std::to_string(n) + ", the smaller first");
    if (!std::isfinite(c.value)) throw InputError(where + "its value is not a finite number");
    if (k > 0 && !(std::pair(problem.couplings[k - 1].a, problem.couplings[k - 1].b) < std::pair(c.a, c.b)))
      throw InputError(where + "couplings must be sorted and each pair given once");
  }
}

Problem to_vartype(const Problem& problem, Vartype vartype) {
  if (problem.vartype == vartype) return problem;
  Problem result = problem;
  result.vartype = vartype;
  if (vartype == Vartype::spin) {  // x = (s + 1) / 2
    for (double& bias : result.linear) {
      bias /= 2;
      result.offset += bias;
    }
    for (Coupling& c : result.couplings) {
      c.value /= 4;
      result.linear[c.a] += c.value;
      result.linear[c.b] += c.value;
      result.offset += c.value;
    }
  } else {  // s = 2 x - 1
    for (double& bias : result.linear) {
      result.offset -= bias;
      bias *= 2;
    }
    for (Coupling& c : result.couplings) {
      result.offset += c.value;
      result.linear[c.a] -= 2 * c.value;
      result.linear[c.b] -= 2 * c.value;
      c.value *= 4;
    }
  }
  return result;
}

double energy(const Problem& problem, std::span<const std::int8_t> row) {
  GONOGO_ASSERT(row.size() == problem.variable_count());
  double sum = problem.offset;
  for (std::size_t i = 0; i < row.size(); ++i) sum += problem.linear[i] * row[i];
  for (const Coupling& c : problem.couplings) sum += c.value * row[c.a] * row[c.b];
  return sum;
}

Problem clamp(const Problem& problem, std::span<const double> values) {
  GONOGO_ASSERT(values.size() == problem.variable_count());
  constexpr std::uint32_t gone = UINT32_MAX;
  Problem result{.vartype = problem.vartype, .offset = problem.offset};
  std::vector<std::uint32_t> position(values.size(), gone);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) {
      position[i] = std::uint32_t(result.linear.size());
      result.linear.push_back(problem.linear[i]);
      result.labels.push_back(problem.labels[i]);
    } else {
      result.offset += problem.linear[i] * values[i];
    }
  }
  for (const Coupling& c : problem.couplings) {
    const std::uint32_t a = position[c.a], b = position[c.b];
    if (a == gone && b == gone)
      result.offset += c.value * values[c.a] * values[c.b];
    else if (a == gone)
      result.linear[b] += c.value * values[c.a];
    else if (b == gone)
      result.linear[a] += c.value * values[c.b];
    else
      result.couplings.push_back({a, b, c.value});
  }
  return result;
}

}  // namespace gonogo::learning
