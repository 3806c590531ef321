// Decodes the rows of an annealer's answer into variables and outcomes.
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/annealer/temperature.h"
#include "learning/qubo/sample_set.h"
#include "pipeline/outcome/qubo/code_machine.h"
#include "pipeline/outcome/qubo/problem_file.h"

namespace gonogo::outcome {

/// How rows with words that are no code words are read.
enum class Decoding {
  weigh,    // the hidden units of every row weigh all code words
  discard,  // such rows are left out
  repair    // those that the rule of the code can read are kept
};
std::string decoding_name(Decoding decoding);

/// Answers below are refused.
struct ImportLimits {
  double reads = 100;         // weigh: independent reads that they are worth; otherwise reads that can be decoded
  double share = 0.05;        // of the reads
  double temperature = 0.15;  // largest distance of the rows' beta from 1; infinite: any rows are taken
};

/// Rows follow exp(-beta E) with this beta, by pseudo-likelihood (learning/annealer/temperature.h), for any number of
/// hidden units. The problem means beta = 1.
struct RowTemperature {
  learning::BetaEstimate beta;
  /// "wrong": the interval, 1 % wider on either side, leaves out 1; "corrected": so it was, and the rows' weights make
  /// up for it, with the error of beta in the standard errors; or "unknown"
  std::string verdict = "right";
};
/// problem: over the variables of the answer, not the qubits.
RowTemperature row_temperature(const learning::Problem& problem, const learning::SampleSet& answer);
/// Throws InputError for rows at another temperature than `limits` allow, and for rows that tell none: each is a local
/// minimum, or the interval is wider than 1.
void expect_temperature(const RowTemperature& temperature, const ImportLimits& limits, const std::string& source);

/// The rows of an answer, decoded by a rule.
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
  double beta_error = 0;  // standard error of the beta that weights are corrected for; 0: they are not
  learning::ReadOrder order;
};

/// `answer` must have passed check_answer(), so its columns are the labels of the problem.
///
/// `weigh` takes of each row its hidden units, which give every code word a probability (code_machine.h); it needs
/// `machine`. Its `rows` are code words drawn with these probabilities by `seed`. With `rows_beta` the rows are known
/// to follow exp(-beta E), and count by exp((beta - 1) E) as well. `discard` leaves out rows with a word that is no
/// code word. `repair` keeps those that the rule can map to a value, and `repaired` counts them. Repaired rows are no
/// samples of the machine's conditional distribution.
DecodedAnswer decode_answer(const Sidecar& sidecar, const learning::SampleSet& answer, Decoding decoding,
                            const CodeMachine* machine, std::uint64_t seed,
                            const std::optional<learning::BetaEstimate>& rows_beta = std::nullopt);

/// CSV with one line for each row. Columns: the variables, outcome, energy, occurrences, and the weight if rows are
/// weighed. Values that are not clamped are the middles of their bins, or uniform inside them, drawn by `inside`.
std::string rows_csv(const Sidecar& sidecar, const DecodedAnswer& decoded,
                     std::optional<std::uint64_t> inside = std::nullopt);

/// Counts of reads, outcome frequencies with standard errors, mean and spread of the variables.
struct AnswerSummary {
  Decoding decoding = Decoding::discard;
  double reads = 0, valid = 0, repaired = 0;  // numbers of reads, counted with their occurrences
  double invalid_share = 0;
  bool free_units = false;  // stand for the code words (CodeMachine::with_free_units())
  bool rows_as_drawn = true;
  struct Outcome {
    std::string name;
    learning::SeriesMean frequency;
    double machine = NAN;        // the machine's own probability (CodeMachine::outcomes()); NaN: not known
    double machine_error = NAN;  // its standard error; 0: it is exact
    double difference = NAN;     // of the frequency from it [standard errors]
  };
  struct Variable {
    std::string name, unit;
    double mean = 0, standard_error = 0, standard_deviation = 0;
  };
  std::vector<Outcome> outcomes;  // none where no row can be read
  std::vector<Variable> variables;
  double independent_reads = 0;  // that the rows are worth
  std::optional<RowTemperature> temperature;
  struct Bias {
    std::string verdict;    // "not checked", "none found", or "biased": more than chance explains
    std::string outcome;    // with the largest difference; empty: there is none
    double difference = 0;  // of that outcome [standard errors]
  } bias;
};
AnswerSummary summarise(const Sidecar& sidecar, const DecodedAnswer& decoded, const CodeMachine* machine);
Json to_json(const AnswerSummary& summary);

/// Throws InputError if the answer has fewer reads of code words, or a smaller share of them, than `limits` ask for.
void expect_enough(const AnswerSummary& summary, const ImportLimits& limits, const std::string& source);

}  // namespace gonogo::outcome
