#include "pipeline/outcome/answer/infer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <istream>
#include <limits>
#include <map>
#include <ostream>
#include <sstream>

#include "base/error.h"
#include "base/files/csv.h"
#include "base/files/file.h"
#include "base/format.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/outcome/answer/predictor.h"

namespace gonogo::outcome {

std::map<std::string, double> parse_named_values(const std::vector<std::string>& texts) {
  std::map<std::string, double> values;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
    double value = 0;
    const auto parsed = std::from_chars(number.data(), number.data() + number.size(), value);
    if (equals == 0 || parsed.ec != std::errc() || parsed.ptr != number.data() + number.size())
      throw InputError("\"" + text + "\" is not of the form variable=number, as in slope_along=12");
    const std::string name = text.substr(0, equals);
    const campaign::Variable& variable = campaign::contract().variables[campaign::contract().variable_index(name)];
    if (!(value >= variable.minimum && value <= variable.maximum))
      throw InputError(text + ": outside the allowed range, " + line("%g to %g ", variable.minimum, variable.maximum) +
                       variable.unit);
    if (!values.emplace(name, value).second)
      throw InputError(line("%s: %s is given twice", text.c_str(), name.c_str()));
  }
  return values;
}

std::vector<double> to_variables(const std::map<std::string, double>& values) {
  std::vector<double> variables(campaign::contract().variables.size(), std::numeric_limits<double>::quiet_NaN());
  for (const auto& [name, value] : values) variables[campaign::contract().variable_index(name)] = value;
  return variables;
}

namespace {

std::vector<Answer::Unknown> reconstruction_of(const Predictor& predictor, const learning::JointAnswer& joint) {
  std::vector<Answer::Unknown> result;
  for (std::size_t v = 0; v < joint.variables.size(); ++v) {
    const learning::UnknownVariable& found = joint.variables[v];
    if (found.probability.empty()) continue;
    const learning::Encoder& encoder = predictor.model().layout.encoders()[v];
    Answer::Unknown unknown{.name = encoder.name(),
                            .unit = encoder.unit(),
                            .mean = found.mean,
                            .deviation = found.deviation,
                            .low = found.low,
                            .high = found.high,
                            .bins = {}};
    for (std::size_t bin = 0; bin < found.probability.size(); ++bin)
      unknown.bins.push_back({encoder.value(int(bin)), found.probability[bin], found.standard_error[bin]});
    result.push_back(std::move(unknown));
  }
  return result;
}

/// A cell of a CSV as a value of a variable.
double cell_value(const std::filesystem::path& file, std::size_t number, const std::string& cell,
                  const campaign::Variable& variable) {
  if (is_missing(cell)) return NAN;
  const auto value = cell_number(cell);
  if (!value)
    refuse_csv_line(file, number,
                    variable.name + ": \"" + cell + "\" is not a number; leave the cell empty if it is unknown");
  if (!campaign::admits(variable, *value))
    refuse_csv_line(file, number,
                    variable.name + ": " + cell + " lies outside " +
                        line("%g to %g ", variable.minimum, variable.maximum) + variable.unit);
  return *value;
}

struct PointTable {
  std::vector<CsvLine> lines;  // the first is the header
  std::vector<double> points;  // [row x variable count]
};

PointTable read_points(const std::filesystem::path& path) {
  PointTable table{read_csv_lines(path, "points; a header of variables is needed"), {}};
  const auto& variables = campaign::contract().variables;
  std::vector<std::size_t> column;
  for (const std::string& name : table.lines.front().cell) {
    column.push_back(campaign::contract().variable_index(name));
    if (std::count(column.begin(), column.end(), column.back()) > 1)
      throw InputError(path.string() + ": column " + name + " appears twice");
  }
  for (std::size_t n = 1; n < table.lines.size(); ++n) {
    const std::size_t number = table.lines[n].number;
    const std::vector<std::string>& cells = table.lines[n].cell;
    if (cells.size() != column.size())
      refuse_csv_line(path, number,
                      std::to_string(cells.size()) + " cells where the header has " + std::to_string(column.size()));
    std::vector<double> point(variables.size(), NAN);
    for (std::size_t k = 0; k < cells.size(); ++k)
      point[column[k]] = cell_value(path, number, cells[k], variables[column[k]]);
    table.points.insert(table.points.end(), point.begin(), point.end());
  }
  return table;
}

/// One word of a conversation applied to the question.
void apply_word(const std::string& word, Question& question) {
  if (word == "clear") {
    question.variables.assign(campaign::contract().variables.size(), NAN);
    question.outcome.reset();
    return;
  }
  const std::size_t equals = word.find('=');
  const std::string name = word.substr(0, equals), value = equals == std::string::npos ? "" : word.substr(equals + 1);
  if (name == "outcome") {
    question.outcome = value == "?" ? std::nullopt : std::optional(outcome_named(value));
  } else if (value == "?") {
    question.variables[campaign::contract().variable_index(name)] = NAN;
  } else {
    const auto given = to_variables(parse_named_values({word}));
    for (std::size_t v = 0; v < given.size(); ++v)
      if (!std::isnan(given[v])) question.variables[v] = given[v];
  }
}

}  // namespace

std::size_t outcome_named(const std::string& name) {
  std::string known;
  for (std::size_t y = 0; y < campaign::contract().outcomes.size(); ++y) {
    if (campaign::contract().outcomes[y].name == name) return y;
    known += (y ? ", " : "") + campaign::contract().outcomes[y].name;
  }
  throw InputError("outcome \"" + name + "\" does not exist; use one of: " + known);
}

Answer answer_question(const Predictor& predictor, const Question& question) {
  const auto& variables = question.variables;
  const bool joint_asked = question.reconstruct || question.outcome;
  const learning::JointAnswer joint =
      joint_asked ? predictor.reconstruct(variables, question.outcome) : learning::JointAnswer{};
  const learning::PosteriorAnswer found = joint_asked ? joint.outcome : predictor.marginal(variables);
  Answer answer;
  answer.gravity = gravity_of(predictor.model());
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    const bool has_it = !campaign::is_task_variable(variable) || predictor.model().sampled_upper[v] > 0;
    if (!std::isnan(variables[v]))
      answer.given.emplace_back(variable.name, variables[v]);
    else if (has_it)
      answer.summed_out.push_back(variable.name);
  }
  if (question.outcome) answer.given_outcome = campaign::contract().outcomes[*question.outcome].name;
  answer.exact = found.exact;
  for (std::size_t y = 0; y < found.probability.size(); ++y) {
    const campaign::Outcome& outcome = campaign::contract().outcomes[y];
    answer.p_go += outcome.verdict != campaign::Verdict::no_go ? found.probability[y] : 0;
    answer.outcomes.push_back({outcome.name, found.probability[y], found.standard_error[y]});
  }
  answer.outside_sampled = predictor.outside_variable(variables);
  answer.novelty = predictor.novelty(variables);
  if (joint_asked) answer.reconstruction = reconstruction_of(predictor, joint);
  return answer;
}

Json to_json(const Answer& answer) {
  Json json, given = Json::object(), outcomes = Json::object();
  for (const auto& [name, value] : answer.given) given[name] = value;
  for (const Answer::Outcome& outcome : answer.outcomes)
    outcomes[outcome.name] =
        Json::Object{{"probability", outcome.probability}, {"standard_error", outcome.standard_error}};
  json[campaign::kGravityKey] = answer.gravity;
  json["given"] = std::move(given);
  if (!answer.given_outcome.empty()) json["given_outcome"] = answer.given_outcome;
  json["summed_out"] = Json(answer.summed_out);
  json["exact"] = answer.exact;
  json["p_go"] = answer.p_go;
  json["outcomes"] = std::move(outcomes);
  json["outside_sampled"] = answer.outside_sampled;
  json["novelty"] = answer.novelty;
  if (!answer.reconstruction) return json;
  Json& reconstruction = json["reconstruction"] = Json::object();
  for (const Answer::Unknown& unknown : *answer.reconstruction) {
    Json bins = Json::array();
    for (const Answer::Unknown::Bin& bin : unknown.bins)
      bins.push_back(Json::Object{
          {"middle", bin.middle}, {"probability", bin.probability}, {"standard_error", bin.standard_error}});
    reconstruction[unknown.name] =
        Json::Object{{"unit", unknown.unit}, {"mean", unknown.mean}, {"deviation", unknown.deviation},
                     {"low", unknown.low},   {"high", unknown.high}, {"bins", std::move(bins)}};
  }
  return json;
}

std::string answer_text(const Answer& answer) {
  std::string text;
  if (!answer.given_outcome.empty()) {
    text += "given that it ended " + answer.given_outcome + ":\n";
  } else {
    for (const Answer::Outcome& outcome : answer.outcomes)
      text += line(outcome.standard_error > 0 ? "%-24s %.4f +- %.4f\n" : "%-24s %.4f\n", outcome.name.c_str(),
                   outcome.probability, outcome.standard_error);
    text += line("P(go or slow-go)         %.4f\n", answer.p_go);
  }
  if (answer.reconstruction && !answer.reconstruction->empty()) {
    text += line("%-24s %10s %10s   %s\n", "unknown", "mean", "deviation", "5 to 95 % within");
    for (const Answer::Unknown& unknown : *answer.reconstruction)
      text += line("%-24s %10.4g %10.4g   %.4g to %.4g %s\n", unknown.name.c_str(), unknown.mean, unknown.deviation,
                   unknown.low, unknown.high, unknown.unit.c_str());
  }
  std::string summed;
  for (const std::string& name : answer.summed_out) summed += " " + name;
  if (!summed.empty()) text += "summed out:" + summed + (answer.exact ? "\n" : " (by sampling)\n");
  if (!answer.outside_sampled.empty())
    text += answer.outside_sampled + " lies outside the range in which trials were made: do not trust this answer\n";
  text += line("gravity of the trials %.4g m/s2\n", answer.gravity);
  return text + line("novelty %.2f (1: as near to a trial as trials are to one another)\n", answer.novelty);
}

std::size_t infer_csv(const Predictor& predictor, const std::filesystem::path& in, const std::filesystem::path& out) {
  const PointTable table = read_points(in);
  const std::size_t variables = campaign::contract().variables.size(), outcomes = campaign::contract().outcomes.size();
  const std::size_t rows = table.lines.size() - 1;
  std::vector<double> p(rows * outcomes);
  predictor.outcome_probabilities(table.points, p);
  std::string text = csv_row(table.lines.front().cell) + ",p_go";
  for (const campaign::Outcome& outcome : campaign::contract().outcomes) text += "," + outcome.name;
  text += ",outside_sampled,novelty\n";
  for (std::size_t n = 0; n < rows; ++n) {
    const auto point = std::span(table.points).subspan(n * variables, variables);
    double go = 0;
    std::string cells;
    for (std::size_t y = 0; y < outcomes; ++y) {
      if (campaign::contract().outcomes[y].verdict != campaign::Verdict::no_go) go += p[n * outcomes + y];
      cells += line(",%.6f", p[n * outcomes + y]);
    }
    text += csv_row(table.lines[n + 1].cell) + line(",%.6f", go) + cells + "," + predictor.outside_variable(point) +
            line(",%.3f\n", predictor.novelty(point));
  }
  write_file_atomically(out, text);
  return rows;
}

void converse(const Predictor& predictor, std::istream& in, std::ostream& out) {
  Question question{std::vector<double>(campaign::contract().variables.size(), NAN), std::nullopt, true};
  out << "variable=number, variable=?, outcome=name, clear, quit\n> " << std::flush;
  for (std::string text; std::getline(in, text); out << "> " << std::flush) {
    std::istringstream words(text);
    Question next = question;
    std::string word;
    try {
      while (words >> word) {
        if (word == "quit") return;
        apply_word(word, next);
      }
      question = next;
      out << answer_text(answer_question(predictor, question));
    } catch (const InputError& error) {
      out << error.what() << "\n";
    }
  }
  out << "\n";
}

}  // namespace gonogo::outcome
