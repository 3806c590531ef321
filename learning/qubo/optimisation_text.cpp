#include "learning/qubo/optimisation_text.h"

#include <numeric>

#include "base/error.h"
#include "learning/qubo/entries.h"
#include "learning/qubo/text_lines.h"

namespace gonogo::learning {
namespace {

/// Energy coefficient = factor x number in the file.
struct Factors {
  double linear, coupling;
};

Factors factors(OptimisationDialect dialect) {
  switch (dialect) {
    case OptimisationDialect::mqlib:
      return {-1, -2};
    case OptimisationDialect::biq_mac:
      return {1, 2};
    default:
      return {0, 1};
  }
}

void check_fit(const Problem& problem, OptimisationDialect dialect) {
  check_problem(problem, "problem");
  const bool rudy = dialect == OptimisationDialect::rudy;
  if (rudy != (problem.vartype == Vartype::spin))
    throw InputError(rudy ? "rudy: the problem is BINARY; convert it to SPIN first"
                          : "MQLib and Biq Mac: the problem is SPIN; convert it to BINARY first");
  for (std::size_t i = 0; rudy && i < problem.linear.size(); ++i)
    if (problem.linear[i] != 0)
      throw InputError("rudy: a maximum cut has no linear biases, " + label_text(problem.labels[i]) +
                       " has one; use another format");
}

std::string number_text(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  double back = 0;
  for (int digits = 1; digits < 17; ++digits) {
    char shorter[40];
    std::snprintf(shorter, sizeof shorter, "%.*g", digits, x);
    if (parse_number(shorter, back) && back == x) return shorter;
  }
  return text;
}

}  // namespace

std::string to_optimisation_text(const Problem& problem, OptimisationDialect dialect) {
  check_fit(problem, dialect);
  const Factors factor = factors(dialect);
  std::string lines;
  std::size_t count = 0;
  const auto append = [&](std::size_t i, std::size_t j, double value) {
    if (value == 0) return;
    lines += std::to_string(i + 1) + " " + std::to_string(j + 1) + " " + number_text(value) + "\n";
    ++count;
  };
  auto next = problem.couplings.begin();
  for (std::size_t i = 0; i < problem.variable_count(); ++i) {
    if (factor.linear != 0) append(i, i, problem.linear[i] / factor.linear);
    for (; next != problem.couplings.end() && next->a == i; ++next) append(i, next->b, next->value / factor.coupling);
  }
  return std::to_string(problem.variable_count()) + " " + std::to_string(count) + "\n" + lines;
}

Problem problem_from_optimisation_text(const std::string& text, OptimisationDialect dialect,
                                       const std::string& source) {
  const Factors factor = factors(dialect);
  const bool rudy = dialect == OptimisationDialect::rudy;
  TextLines lines(text, source);
  std::int64_t variables = -1, declared = 0;
  std::vector<Entry> entries;
  while (lines.next()) {
    if (!rudy && lines.words()[0][0] == '#') continue;
    if (variables < 0) {
      lines.expect_words(2);
      variables = lines.integer(0, 0, kMaxVariables);
      declared = lines.integer(1, 0, INT32_MAX);
      continue;
    }
    lines.expect_words(3);
    const Entry e{lines.integer(0, 1, variables) - 1, lines.integer(1, 1, variables) - 1, lines.number(2)};
    if (rudy && e.i == e.j) lines.fail("an edge from a node to itself");
    entries.push_back({e.i, e.j, e.value * (e.i == e.j ? factor.linear : factor.coupling)});
  }
  if (variables < 0) throw InputError(source + ": no line \"variables lines\"");
  if (std::int64_t(entries.size()) != declared)
    throw InputError(source + ": " + std::to_string(entries.size()) + " lines of coefficients where " +
                     std::to_string(declared) + " are declared");
  std::vector<std::int64_t> ids(static_cast<std::size_t>(variables));
  std::iota(ids.begin(), ids.end(), 0);
  return problem_from_entries(rudy ? Vartype::spin : Vartype::binary, ids, entries, Repeats::refuse, source);
}

}  // namespace gonogo::learning
