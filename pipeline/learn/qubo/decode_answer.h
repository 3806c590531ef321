// Rows of an answer -> variables and outcomes.
#pragma once
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/qubo/sample_set.h"
#include "pipeline/learn/qubo/qubo_exchange.h"

namespace gonogo::learn {

struct DecodedAnswer {
  struct Row {
    std::vector<double> values;  // [variable count], in their units; clamped variables at their given values
    std::size_t outcome = 0;
    double energy = 0;
    std::int64_t occurrences = 1;
  };
  std::vector<Row> rows;                      // those with a value for every variable and exactly one outcome
  double reads = 0, valid = 0, repaired = 0;  // counted with their occurrences
};

/// answer must have passed check_answer(): its columns are the labels of the problem. Rows that are no code word
/// throughout are left out under `discard`; `repair` keeps those that the rule gives a value (`repaired` counts them),
/// which are then no longer samples of the machine's conditional distribution.
DecodedAnswer decode_answer(const Sidecar& sidecar, const learning::SampleSet& answer, learning::DecodeRule rule);

/// variable names, outcome, energy, occurrences; one line for each valid row.
std::string rows_csv(const Sidecar& sidecar, const DecodedAnswer& decoded);

Json summary_json(const Sidecar& sidecar, const DecodedAnswer& decoded);

}  // namespace gonogo::learn
