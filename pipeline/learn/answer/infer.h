// Answers questions to a model: about one point, about a table of points, or in a dialogue.
#pragma once
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/learn/answer/predictor.h"

namespace gonogo::learn {

struct Question {
  std::vector<double> variables;       // [variable count]; NaN: unknown
  std::optional<std::size_t> outcome;  // if given: the outcome that the trial had
  bool reconstruct = false;            // also infer the unknown variables
};

/// Position of an outcome in the contract. Throws InputError for an unknown name and lists the valid ones.
std::size_t outcome_named(const std::string& name);

/// Answers one question:
/// { given, summed_out, exact, p_go, outcomes: {name: {probability, standard_error}}, outside_sampled, novelty,
///   reconstruction: {name: {mean, deviation, low, high, bins: [...]}} }
Json answer_question(const Predictor& predictor, const Question& question);
/// The same as text for people.
std::string answer_text(const Json& answer);

/// Answers every row of a CSV. Its header names variables of the contract, in any order; an empty cell is unknown. The
/// output has the same columns, then p_go, one column per outcome, outside_sampled and novelty. Returns the number of
/// rows. Throws InputError for columns that are no variables, cells that are no numbers, and values out of range.
std::size_t infer_csv(const Predictor& predictor, const std::filesystem::path& in, const std::filesystem::path& out);

/// Reads lines "variable=number ...", "variable=?", "outcome=name", "clear" and "quit", and prints the answer after
/// each. For a line that cannot be read it prints the reason; the question stays as it was.
void converse(const Predictor& predictor, std::istream& in, std::ostream& out);

}  // namespace gonogo::learn
