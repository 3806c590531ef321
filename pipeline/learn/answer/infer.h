// Questions to a model as people and files ask them: a point, a table of points, a conversation.
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
  std::vector<double> variables;       // [variable count], not-a-number where unknown
  std::optional<std::size_t> outcome;  // "if it went so, what were the others?"
  bool reconstruct = false;            // also tell the unknown variables
};

/// Position of an outcome; throws InputError naming those that exist.
std::size_t outcome_named(const std::string& name);

/// { given, summed_out, exact, p_go, outcomes: {name: {probability, standard_error}}, outside_sampled, novelty,
///   reconstruction: {name: {mean, deviation, low, high, bins: [...]}} }
Json answer_question(const Predictor& predictor, const Question& question);
std::string answer_text(const Json& answer);

/// Answers every row of a CSV whose header names variables of the contract (any of them, in any order; empty cells are
/// unknown): the same columns, then p_go, one column for each outcome, outside_sampled and novelty. Returns the number
/// of rows. Throws InputError for columns that are no variables, cells that are no numbers and values out of range.
std::size_t infer_csv(const Predictor& predictor, const std::filesystem::path& in, const std::filesystem::path& out);

/// Reads lines "variable=number ...", "variable=?", "outcome=name", "clear" and "quit", and answers after each. A line
/// that cannot be read is explained and changes nothing.
void converse(const Predictor& predictor, std::istream& in, std::ostream& out);

}  // namespace gonogo::learn
