// Decodes the rows of an annealer's answer into variables and outcomes.
#pragma once
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/qubo/sample_set.h"
#include "pipeline/learn/qubo/qubo_exchange.h"

namespace gonogo::learn {

struct DecodedAnswer {
  struct Row {
    std::vector<double> values;  // [variable count], contract units; clamped ones as given
    std::size_t outcome = 0;
    double energy = 0;  // as the answer gives it
    std::int64_t occurrences = 1;
  };
  std::vector<Row> rows;                      // a value for every variable and exactly one outcome
  double reads = 0, valid = 0, repaired = 0;  // numbers of reads, counted with their occurrences
};

/// `answer` must have passed check_answer(), so its columns are the labels of the problem. `discard` leaves out rows
/// with a word that is no code word. `repair` keeps those that the rule can map to a value, and `repaired` counts them.
/// Repaired rows are no samples of the machine's conditional distribution.
DecodedAnswer decode_answer(const Sidecar& sidecar, const learning::SampleSet& answer, learning::DecodeRule rule);

/// CSV with one line for each valid row. Columns: the variables, outcome, energy, occurrences.
std::string rows_csv(const Sidecar& sidecar, const DecodedAnswer& decoded);

/// Counts of reads, outcome frequencies with standard errors, mean and spread of the variables.
Json summary_json(const Sidecar& sidecar, const DecodedAnswer& decoded);

}  // namespace gonogo::learn
