// An exported machine as a distribution over code words.
//
// Given the hidden units h, the units of different variables are independent. So the code words of every variable, and
// the outcomes, can be summed exactly: P(h, word) is proportional to exp(-E(h, word)), over code words only. An
// answer's row then counts by its hidden units alone. Rows of a machine without penalty have P(h) summed over all
// words; the weight of a row is the ratio of the two sums (importance sampling). Nothing is lost where units are no
// code words.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/machine/word_machine.h"
#include "learning/qubo/problem.h"

namespace gonogo::outcome {

/// A free variable of the layout or the outcome.
struct CodeGroup {
  std::ptrdiff_t variable = -1;                 // index in the layout; -1: the outcome
  std::vector<std::uint32_t> unit;              // positions in the problem
  std::vector<std::vector<std::uint8_t>> word;  // [bin][unit]
};

class CodeMachine {
 public:
  /// `problem`: the exported problem, or the source of its embedding. None if units of different variables are coupled,
  /// or if the hidden units are coupled with one another.
  static std::optional<CodeMachine> of(const learning::Problem& problem, const learning::VisibleLayout& layout);

  struct Given {
    std::vector<std::vector<double>> probability;  // [group][bin]
    double log_words = 0;                          // log of the sum over code words, -h's own energy included
    double log_all = 0;                            // the same over all words of the units
  };
  /// row: [variable of the problem], on where above 0. Only hidden units are looked at.
  Given given(std::span<const std::int8_t> row) const;

  /// Sums over all hidden rows.
  struct Exact {
    std::vector<std::vector<double>> probability;  // [group][bin]: marginals over code words
    double word_share = 1;                         // of the rows that are code words
    double weighed_share = 1;  // share of reads that weighed rows are worth: 1 / (1 + relative variance of the weights)
  };
  /// None with more than 16 hidden units.
  std::optional<Exact> exact() const;
  /// P(outcome) with standard errors: of these sums, without an error; otherwise by block Gibbs over code words here,
  /// in 32 chains with replicas at inverse temperatures 0 to 1. Deterministic. Empty where the outcome is not free.
  struct Reference {
    std::vector<double> probability, standard_error;  // [outcome]
  };
  Reference outcomes() const;
  /// P(outcome) of the exact sums; empty where there are none.
  std::vector<double> exact_outcomes() const;

  const std::vector<CodeGroup>& groups() const { return groups_; }
  /// The problem in the order of given()'s rows, BINARY.
  const learning::Problem& binary() const { return problem_; }

 private:
  /// Energy of each unit of the group when it is on alone, given the hidden units of `row`.
  std::vector<double> fields(const CodeGroup& group, std::span<const std::int8_t> row) const;
  template <class On>
  double word_energy(const CodeGroup& group, std::span<const double> field, On on) const;
  double log_all_words(const CodeGroup& group, std::span<const double> field) const;
  /// The machine over the code words of groups().
  learning::WordMachine words() const;
  learning::Problem problem_;  // BINARY
  std::vector<CodeGroup> groups_;
  std::vector<std::uint32_t> hidden_;          // positions in the problem
  std::vector<std::vector<double>> coupling_;  // [position of a unit][hidden unit]
  std::vector<std::vector<double>> inside_;    // [position of a unit][position in its group]; empty: none coupled
};

}  // namespace gonogo::outcome
