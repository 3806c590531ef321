// Answers questions to a model: about one point, about a table of points, or in a dialogue.
#pragma once
#include <filesystem>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/json/json.h"
#include "pipeline/outcome/answer/predictor.h"

namespace gonogo::outcome {

struct Question {
  std::vector<double> variables;       // [variable count]; NaN: unknown
  std::optional<std::size_t> outcome;  // if given: the outcome that the trial had
  bool reconstruct = false;            // also infer the unknown variables
};

/// Position of an outcome in the contract. Throws InputError for an unknown name and lists the valid ones.
std::size_t outcome_named(const std::string& name);

struct Answer {
  double gravity = 0;                                 // of the trials [m/s^2]
  std::vector<std::pair<std::string, double>> given;  // [unit of the variable]
  std::string given_outcome;                          // empty: none
  std::vector<std::string> summed_out;                // unknown variables
  bool exact = true;                                  // summed, not sampled
  double p_go = 0;                                    // of go or slow_go
  struct Outcome {
    std::string name;
    double probability = 0, standard_error = 0;
  };
  std::vector<Outcome> outcomes;
  std::string outside_sampled;  // a variable that lies outside the range in which trials were made; empty: none
  double novelty = 0;
  struct Unknown {
    std::string name, unit;
    double mean = 0, deviation = 0, low = 0, high = 0;
    struct Bin {
      double middle = 0, probability = 0, standard_error = 0;
    };
    std::vector<Bin> bins;
  };
  std::optional<std::vector<Unknown>> reconstruction;  // where it was asked for, or the outcome was given
};

Answer answer_question(const Predictor& predictor, const Question& question);
Json to_json(const Answer& answer);
/// For people.
std::string answer_text(const Answer& answer);

/// Answers every row of a CSV. Its header names variables of the contract, in any order; an empty cell is unknown. The
/// output has the same columns, then p_go, one column per outcome, outside_sampled and novelty. Returns the number of
/// rows. Throws InputError for columns that are no variables, cells that are no numbers, and values out of range.
std::size_t infer_csv(const Predictor& predictor, const std::filesystem::path& in, const std::filesystem::path& out);

/// Reads lines "variable=number ...", "variable=?", "outcome=name", "clear" and "quit", and prints the answer after
/// each. For a line that cannot be read it prints the reason; the question stays as it was.
void converse(const Predictor& predictor, std::istream& in, std::ostream& out);

/// Values of variables as the command line gives them: "slope_along=12". Parses name=number pairs. Throws InputError
/// for texts of another form, numbers outside the contract's range, and variables given twice. For an unknown variable
/// the error suggests the nearest valid name.
std::map<std::string, double> parse_named_values(const std::vector<std::string>& texts);

/// The values in the order of the contract [variable count]; NaN where none was given.
std::vector<double> to_variables(const std::map<std::string, double>& values);

}  // namespace gonogo::outcome
