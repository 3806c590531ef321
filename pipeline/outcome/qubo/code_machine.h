// An exported machine as a distribution over code words.
//
// Given the hidden units h, the units of different variables are independent. So the code words of every variable, and
// the outcomes, can be summed exactly: P(h, word) is proportional to exp(-E(h, word)), over code words only. An
// answer's row then counts by its hidden units alone. Rows of a machine without penalty have P(h) summed over all
// words; the weight of a row is the ratio of the two sums (importance sampling). Nothing is lost where units are no
// code words.
//
// A problem of free units (learning/machine/free_units.h) holds no units of code words. Then the machine over code
// words stands beside it, and the weight of a row is the ratio of the machine's P(h) and the problem's.
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
  /// The machine `words` over code words, with rows of `problem`: the hidden units of `words` by their labels, and free
  /// units, each coupled with hidden units alone. Throws InputError for another problem.
  static CodeMachine with_free_units(const learning::Problem& words, const learning::Problem& problem,
                                     const learning::VisibleLayout& layout);

  struct Given {
    std::vector<std::vector<double>> probability;  // [group][bin]
    double log_words = 0;                          // log of the sum over code words, -h's own energy included
    double log_all = 0;                            // the same over all words of the units, or all free units
  };
  /// row: [variable of the problem], on where above 0. Only hidden units are looked at.
  Given given(std::span<const std::int8_t> row) const;

  /// Sums over all hidden rows.
  struct Exact {
    std::vector<std::vector<double>> probability;  // [group][bin]: marginals over code words
    double word_share = 1;                         // of the rows that are code words; 1 with free units
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
  /// P(outcome) by sums over all hidden rows, or over all code words where these have at most 4,096 combinations; empty
  /// where both have more.
  std::vector<double> exact_outcomes() const;

  const std::vector<CodeGroup>& groups() const { return groups_; }
  /// The problem in the order of given()'s rows, BINARY.
  const learning::Problem& binary() const { return free_ ? free_->problem : problem_; }
  bool has_free_units() const { return free_.has_value(); }

 private:
  /// Energy of each unit of the group when it is on alone, given the hidden units of `row`.
  std::vector<double> fields(const CodeGroup& group, std::span<const std::int8_t> row) const;
  template <class On>
  double word_energy(const CodeGroup& group, std::span<const double> field, On on) const;
  double log_all_words(const CodeGroup& group, std::span<const double> field) const;
  /// log of the sum over all free units, the hidden units' own energy included.
  double log_all_free(std::span<const std::int8_t> row) const;
  /// The machine over the code words of groups().
  learning::WordMachine words() const;
  struct FreeUnits {
    learning::Problem problem;                  // BINARY
    std::vector<std::uint32_t> unit;            // positions in it
    std::vector<std::vector<double>> coupling;  // [free unit][hidden unit]
  };
  learning::Problem problem_;  // BINARY, over code words
  std::vector<CodeGroup> groups_;
  std::vector<std::uint32_t> hidden_;  // positions in the problem
  std::vector<std::uint32_t> column_;  // positions of the hidden units in rows
  std::optional<FreeUnits> free_;
  std::vector<std::vector<double>> coupling_;  // [position of a unit][hidden unit]
  std::vector<std::vector<double>> inside_;    // [position of a unit][position in its group]; empty: none coupled
};

}  // namespace gonogo::outcome
