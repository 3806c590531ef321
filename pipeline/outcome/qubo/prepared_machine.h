// Chooses the units of an exported machine, where the user does not ask for a penalty.
#pragma once
#include <optional>
#include <string>

#include "learning/machine/word_machine.h"
#include "learning/model/model.h"
#include "learning/qubo/problem.h"
#include "pipeline/outcome/qubo/code_machine.h"

namespace gonogo::outcome {

/// What rows of a machine without penalty are worth.
struct WordShares {
  double words = 0, weighed = 0;  // as in CodeMachine::Exact
  bool exact = false;
};

/// Sums over up to 16 hidden units. With more, means over 400 rows of tempering, where a row's hidden units give the
/// share of code words among all words.
WordShares word_shares(const CodeMachine& machine);

struct PreparedMachine {
  learning::Problem problem;  // BINARY, without what is known
  /// The machine over code words, BINARY, if `problem` has free units in place of code words
  /// (CodeMachine::with_free_units()).
  std::optional<learning::Problem> words;
  std::string note;  // what was done and why, for people; empty when there is nothing to say
  CodeMachine code_machine(const learning::VisibleLayout& layout) const;
};

/// The machine as a QUBO over the units of the layout, which is clamped to what is known.
learning::Problem plain_machine(const learning::Model& model, const learning::KnownPart& known);

/// The same with a penalty on words that are no code words (with_code_penalty()).
learning::Problem penalised_machine(const learning::Model& model, const learning::KnownPart& known, double strength);

/// What rows of the machine with this penalty are worth, for people. Empty where every row is one of code words, and
/// where a penalised variable has too many units to list its words.
std::string penalty_note(const learning::Problem& penalised, const learning::VisibleLayout& layout, double strength);

/// Free units in place of code words: 20, or one for each word beyond the first of every group where these are fewer.
/// No two of them are coupled, nor two hidden units, and every row of hidden units gives code words.
PreparedMachine machine_of_free_units(const learning::Model& model, const learning::KnownPart& known);

/// The plain machine if every row of it is one of code words, or if weighed rows of up to 16 hidden units are worth
/// half of the reads; otherwise free units.
PreparedMachine prepared_machine(const learning::Model& model, const learning::KnownPart& known);

}  // namespace gonogo::outcome
