// How well a model tells hidden inputs of a trial from its outcome and the other inputs.
#pragma once
#include <string>

#include "base/json/json.h"
#include "learning/table.h"
#include "pipeline/learn/answer/predictor.h"

namespace gonogo::learn {

struct ReconstructionSettings {
  std::size_t max_rows = 250;  // drawn by the seed
  std::uint64_t seed = 1;
};

/// Hides every pair of inputs that the trials varied, of each of the rows, and asks Predictor::reconstruct() for both,
/// given the outcome and the other inputs. Rows with an unknown input are left out.
///
/// "coverage"   share of the hidden values that lie in their interval of 90 % (low to high): { value, low, high }
/// "gain_nat"   mean of log p(value) by the model minus that by the prior of the inputs, per hidden value; both
///              densities are constant in a bin: { value, low, high }
/// "variables"  { name: { coverage, gain_nat } } as numbers
///
/// Intervals of 95 % are by bootstrap over rows. { rows, pairs, coverage, gain_nat, variables }, or { "left_out":
/// reason } where fewer than two inputs vary or no row is whole.
Json reconstruction_scores(const Predictor& predictor, const learning::TrainingTable& table,
                           const ReconstructionSettings& settings = {});
std::string reconstruction_text(const Json& scores);

}  // namespace gonogo::learn
