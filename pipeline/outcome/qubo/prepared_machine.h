// Chooses how an exported machine keeps its rows code words, where the user does not say.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "learning/model/model.h"
#include "learning/qubo/problem.h"

namespace gonogo::outcome {

struct PreparedMachine {
  learning::Problem machine;  // BINARY: the units of the layout, then the hidden ones; without the penalty
  double penalty = 0;         // in the energy unit of the problem, for with_code_penalty()
  std::string note;           // what was done and why, for people; empty when there is nothing to say
};

/// fixed: the values of the units of clamped variables, as in with_code_penalty().
///
/// The machine stays as it is if weighed rows are worth a tenth of the reads or more. Otherwise its outcome is balanced
/// (balanced_machine()); if that is not enough it gets measured_penalty(). What weighed rows are worth is summed over
/// up to 16 hidden units, and measured on 1,000 rows of tempering with more. The note states it and the share of rows
/// that are code words.
PreparedMachine prepared_machine(const learning::Model& model, const std::vector<double>& fixed);

/// What rows of a machine without penalty are worth.
struct WordShares {
  double words = 0, weighed = 0;  // as in CodeMachine::Exact
  bool exact = false;
};

/// Exact sums, or means over rows of tempering, where a row's hidden units give the share of code words among all
/// words. None if the machine couples units of different variables.
std::optional<WordShares> word_shares(const learning::Problem& machine, const learning::VisibleLayout& layout,
                                      const std::vector<double>& fixed);

/// The first of 8, 12, 16, 24, 32 that leaves at most a tenth of the rows without a code word, by a short run of
/// tempering; 32 when none does. `machine` as in PreparedMachine.
double measured_penalty(const learning::Problem& machine, const learning::VisibleLayout& layout,
                        const std::vector<double>& fixed);

/// A machine with the same rows of code words, whose outcome is a code word more often: the whole machine as a QUBO
/// (to_qubo() of learning/model/weights.h), balanced for rows of which nothing is known. It serves clamped questions
/// better than a balance of their own: its hidden units are more varied. Deterministic.
///
/// In a code word exactly one of the outcome's units u_y is on. So (c + w.h) (1 - sum_y u_y) can be added to the
/// energy: code words keep theirs to the rounding, and no two visible units get coupled, as a penalty would. c and w
/// are chosen so that, given the hidden units of the machine's own code words, one outcome unit is on in the mean. That
/// is the least mean of log(all words / code words), which is convex in c and w. Training on code words leaves both
/// free.
learning::Problem balanced_machine(const learning::Model& model);

}  // namespace gonogo::outcome
