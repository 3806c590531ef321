// Text "n m" and m lines "i j w", numbered from 1. The same syntax has three meanings:
//
//   MQLib      maximise   sum_i w_ii x_i + 2 sum_(i<j) w_ij x_i x_j   x in {0, 1}   (github.com/MQLib/MQLib)
//   Biq Mac    minimise   sum_i w_ii x_i + 2 sum_(i<j) w_ij x_i x_j   x in {0, 1}   (biqmac.aau.at: Q is symmetric)
//   rudy       maximise   sum_(cut edges ij) w_ij, a maximum cut                     (G-set, BiqMac library .mc)
//
// As energies to minimise:
//   MQLib      E = -objective: linear -w_ii, coupling -2 w_ij
//   Biq Mac    linear w_ii, coupling 2 w_ij
//   rudy       J_ij = w_ij with spins for the two sides of the cut; E = W - 2 cut, W the sum of all weights
#include <numeric>

#include "base/error.h"
#include "base/format.h"
#include "learning/formats/format.h"
#include "learning/qubo/text.h"

namespace gonogo::learning {
namespace {

/// Energy coefficient = factor x number in the file.
struct Dialect {
  bool rudy;
  double linear, coupling;
};
constexpr Dialect kMqlibDialect = {false, -1, -2}, kBiqMacDialect = {false, 1, 2}, kRudyDialect = {true, 0, 1};

void check_fit(const Problem& problem, bool rudy) {
  check_problem(problem, "problem");
  if (rudy != (problem.vartype == Vartype::spin))
    throw InputError(rudy ? "rudy: the problem is BINARY; convert it to SPIN first"
                          : "MQLib and Biq Mac: the problem is SPIN; convert it to BINARY first");
  for (std::size_t i = 0; rudy && i < problem.linear.size(); ++i)
    if (problem.linear[i] != 0)
      throw InputError("rudy: a maximum cut has no linear biases, " + label_text(problem.labels[i]) +
                       " has one; use another format");
}

std::string shortest_text(double x) {
  double back = 0;
  for (int digits = 1; digits < 17; ++digits)
    if (const std::string text = line("%.*g", digits, x); parse_number(text, back) && back == x) return text;
  return line("%.17g", x);
}

/// Variable k has number k + 1. Coefficients of 0 and the offset are left out.
template <const Dialect& factor>
std::string to_optimisation_text(const Problem& problem, const FormatOptions&) {
  check_fit(problem, factor.rudy);
  std::string lines;
  std::size_t count = 0;
  const auto append = [&](std::size_t i, std::size_t j, double value) {
    if (value == 0) return;
    lines += std::to_string(i + 1) + " " + std::to_string(j + 1) + " " + shortest_text(value) + "\n";
    ++count;
  };
  auto next = problem.couplings.begin();
  for (std::size_t i = 0; i < problem.variable_count(); ++i) {
    if (factor.linear != 0) append(i, i, problem.linear[i] / factor.linear);
    for (; next != problem.couplings.end() && next->a == i; ++next) append(i, next->b, next->value / factor.coupling);
  }
  return std::to_string(problem.variable_count()) + " " + std::to_string(count) + "\n" + lines;
}

/// Labels are the numbers less one. Throws InputError unless counts match, numbers are in range, and each pair is given
/// once, in either order. Lines that begin with # are comments, except in rudy.
template <const Dialect& factor>
Problem problem_from_optimisation_text(const std::string& text, const FormatOptions&, const std::string& source) {
  const bool rudy = factor.rudy;
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

template <const Dialect& dialect>
constexpr Format format(const char* name, const char* extension, const char* about) {
  return {.name = name,
          .extension = extension,
          .about = about,
          .binary = !dialect.rudy,
          .spin = dialect.rudy,
          .labels = false,
          .from_one = true,
          .offset = false,
          .zeros = false,
          .write = to_optimisation_text<dialect>,
          .read = problem_from_optimisation_text<dialect>};
}

}  // namespace

extern const Format kMqlib = format<kMqlibDialect>("mqlib", ".mqlib", "MQLib: maximise, symmetric matrix");
extern const Format kBiqMac = format<kBiqMacDialect>("biq_mac", ".bq", "Biq Mac: minimise, symmetric matrix");
extern const Format kRudy = format<kRudyDialect>("rudy", ".mc", "rudy, G-set: maximum cut, no linear biases");

}  // namespace gonogo::learning
