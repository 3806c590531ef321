// Decodes the rows of an annealer's answer into variables and outcomes.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/qubo/read_series.h"
#include "learning/qubo/sample_set.h"
#include "pipeline/learn/qubo/code_machine.h"
#include "pipeline/learn/qubo/qubo_exchange.h"

namespace gonogo::learn {

/// What every row of the answer says, by the rule of decoding.
struct DecodedAnswer {
  struct Row {
    std::vector<double> values;  // [variable count], contract units; clamped ones as given
    std::size_t outcome = 0;
    double energy = 0;  // as the answer gives it
    std::int64_t occurrences = 1;
    double weight = 1;
  };
  Decoding decoding = Decoding::discard;
  std::vector<Row> rows;                      // rows with weight: a value for every variable and exactly one outcome
  double reads = 0, valid = 0, repaired = 0;  // numbers of reads, counted with their occurrences
  std::vector<std::int64_t> occurrences;      // [answer row]
  std::vector<double> weight;                 // [answer row], 0: left out
  std::vector<std::vector<double>> outcome;   // [outcome][answer row] probability that the row gives it
  std::vector<std::vector<double>> mean, square;  // [variable][answer row] of the value and of its square
  learning::ReadOrder order;
};

/// `answer` must have passed check_answer(), so its columns are the labels of the problem.
///
/// `weigh` takes of each row its hidden units, which give every code word a probability (code_machine.h); it needs
/// `machine`. Its `rows` are code words drawn with these probabilities by `seed`. `discard` leaves out rows with a word
/// that is no code word. `repair` keeps those that the rule can map to a value, and `repaired` counts them. Repaired
/// rows are no samples of the machine's conditional distribution.
DecodedAnswer decode_answer(const Sidecar& sidecar, const learning::SampleSet& answer, Decoding decoding,
                            const CodeMachine* machine, std::uint64_t seed);

/// CSV with one line for each row. Columns: the variables, outcome, energy, occurrences, and the weight if rows are
/// weighed. Values that are not clamped are the middles of their bins, or uniform inside them, drawn by `inside`.
std::string rows_csv(const Sidecar& sidecar, const DecodedAnswer& decoded,
                     std::optional<std::uint64_t> inside = std::nullopt);

/// Counts of reads, outcome frequencies with standard errors, mean and spread of the variables. With `exact` also the
/// machine's own probabilities and the differences in standard errors, and in "bias" whether they are larger than
/// chance explains.
Json summary_json(const Sidecar& sidecar, const DecodedAnswer& decoded, const CodeMachine* machine);

/// Throws InputError if the answer has fewer reads of code words, or a smaller share of them, than `limits` ask for.
void expect_enough(const DecodedAnswer& decoded, const Json& summary, const ImportLimits& limits,
                   const std::string& source);

}  // namespace gonogo::learn
