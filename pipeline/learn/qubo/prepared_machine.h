// What an exported machine gets so that enough of its rows are code words, when nobody says.
#pragma once
#include <string>
#include <vector>

#include "learning/model/model.h"
#include "learning/qubo/problem.h"

namespace gonogo::learn {

struct PreparedMachine {
  learning::Problem machine;  // BINARY: the units of the layout, then the hidden ones; without the penalty
  double penalty = 0;         // in the energy unit of the problem, for with_code_penalty()
  std::string note;           // what was done and why, for people; empty when there is nothing to say
};

/// fixed: the values of the units of clamped variables, as in with_code_penalty().
///
/// The machine stays as it is if weighed rows are worth a tenth of the reads or more. Otherwise its outcome is balanced
/// (outcome_balance.h); if that is not enough it gets measured_penalty(). Sums over up to 16 hidden units say what
/// weighed rows are worth; with more hidden units there is a penalty.
PreparedMachine prepared_machine(const learning::Model& model, const std::vector<double>& fixed);

/// The first of 8, 12, 16, 24, 32 that leaves at most a tenth of the rows without a code word, by a short run of
/// tempering; 32 when none does. `machine` as in PreparedMachine.
double measured_penalty(const learning::Problem& machine, const learning::VisibleLayout& layout,
                        const std::vector<double>& fixed);

}  // namespace gonogo::learn
