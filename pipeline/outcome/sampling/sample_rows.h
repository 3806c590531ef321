// Draws rows of variables and outcome from a model.
//
//   machine  the machine's joint distribution over its code words, P(variables, outcome | known ones)
//   prior    variables from the model's prior of inputs, the outcome from P(outcome | variables)
//
// Numbers are uniform inside the bin that was drawn, or its middle.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/machine/word_machine.h"
#include "learning/score/mixing.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"

namespace gonogo::outcome {

enum class RowSource { machine, prior };

/// Samplers of the machine's joint distribution:
///   auto         exact where it can be, otherwise tempering
///   exact        sum over all rows (learning/machine/word_machine.h); independent rows
///   code_words   block Gibbs over code words (learning/machine/word_machine.h)
///   tempering    the same with `rungs` temperatures
///   block_gibbs, anneal, population, emulator
///                rows of single units, as an annealer draws them: free units stand for the words, which the hidden
///                units give (prepared_machine.h)
std::vector<std::string> row_samplers();

struct RowRequest {
  std::size_t rows = 1000;
  std::vector<double> known;           // [variable count] as in Predictor, NaN: to be drawn
  std::optional<std::size_t> outcome;  // given: rows of this outcome
  RowSource source = RowSource::machine;
  std::string sampler = "auto";
  std::size_t chains = 8, rungs = 8;  // rungs: of tempering
  std::size_t burn_in = 1000;         // sweeps before a chain's first row
  std::size_t every = 10;             // sweeps between rows of a chain
  bool inside = true;                 // values inside the bins; otherwise their middles
  DeviceChoice device;                // of the emulator
  std::uint64_t seed = 1;
};

struct SampledRows {
  std::size_t variable_count = 0;
  std::vector<double> values;        // [row x variable]
  std::vector<std::size_t> outcome;  // [row]
  std::vector<std::uint32_t> chain;  // [row]; rows of one chain are in their order
  std::size_t chains = 1;
  std::string sampler;                        // that drew the rows
  bool independent = false;                   // by construction; chains are then parts of the rows
  std::vector<learning::Mixing> of_variable;  // [variable]; NaN where it was known or is fixed
  learning::Mixing of_outcome;                // of passable or not; NaN where it was known

  std::size_t row_count() const { return outcome.size(); }
  std::span<const double> row(std::size_t n) const {
    return std::span(values).subspan(n * variable_count, variable_count);
  }
};

/// The same request gives the same bits for any number of threads. Throws InputError for a sampler that the machine
/// does not support, no rows or chains, a prior that the model does not have, and an outcome that the known values
/// exclude.
SampledRows sample_rows(const Predictor& predictor, const RowRequest& request);

}  // namespace gonogo::outcome
