#include "pipeline/learn/answer/infer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <istream>
#include <map>
#include <ostream>
#include <sstream>

#include "base/error.h"
#include "base/file.h"
#include "base/line.h"
#include "pipeline/campaign/study/task_variables.h"
#include "pipeline/learn/answer/model_gravity.h"
#include "pipeline/learn/answer/named_values.h"

namespace gonogo::learn {
namespace {

Json reconstruction_json(const Predictor& predictor, const learning::JointAnswer& joint) {
  Json json = Json::object();
  for (std::size_t v = 0; v < joint.variables.size(); ++v) {
    const learning::UnknownVariable& unknown = joint.variables[v];
    if (unknown.probability.empty()) continue;
    const learning::Encoder& encoder = predictor.model().layout.encoders()[v];
    Json entry, bins = Json::array();
    entry["unit"] = encoder.unit();
    entry["mean"] = unknown.mean;
    entry["deviation"] = unknown.deviation;
    entry["low"] = unknown.low;
    entry["high"] = unknown.high;
    for (std::size_t bin = 0; bin < unknown.probability.size(); ++bin) {
      Json cell;
      cell["middle"] = encoder.value(int(bin));
      cell["probability"] = unknown.probability[bin];
      cell["standard_error"] = unknown.standard_error[bin];
      bins.push_back(std::move(cell));
    }
    entry["bins"] = std::move(bins);
    json[encoder.name()] = std::move(entry);
  }
  return json;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> cells;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    std::string cell = text.substr(begin, end - begin);
    cell.erase(0, cell.find_first_not_of(" \t\r"));
    cell.erase(cell.find_last_not_of(" \t\r") + 1);
    cells.push_back(std::move(cell));
    if (end == text.size()) return cells;
    begin = end + 1;
  }
}

/// A cell of a CSV as a value of a variable.
double cell_value(const std::string& cell, std::size_t variable, const std::string& where) {
  if (cell.empty()) return NAN;
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  const campaign::Variable& v = campaign::contract().variables[variable];
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    throw InputError(where + v.name + ": \"" + cell + "\" is not a number; leave the cell empty if it is unknown");
  if (value < v.minimum || value > v.maximum)
    throw InputError(where + v.name + ": " + cell + " lies outside " + line("%g to %g ", v.minimum, v.maximum) +
                     v.unit);
  return value;
}

struct PointTable {
  std::string header;
  std::vector<std::string> lines;
  std::vector<double> points;  // [row x variable count]
};

PointTable read_points(const std::filesystem::path& path) {
  std::istringstream in(read_file(path));
  PointTable table;
  std::string text;
  if (!std::getline(in, table.header)) throw InputError(path.string() + ": is empty; a header of variables is needed");
  if (!table.header.empty() && table.header.back() == '\r') table.header.pop_back();
  std::vector<std::size_t> column;
  for (const std::string& name : split(table.header, ',')) {
    column.push_back(campaign::contract().variable_index(name));
    if (std::count(column.begin(), column.end(), column.back()) > 1)
      throw InputError(path.string() + ": column " + name + " appears twice");
  }
  for (std::size_t number = 2; std::getline(in, text); ++number) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    if (text.empty()) continue;
    const std::string where = path.string() + ": line " + std::to_string(number) + ": ";
    const auto cells = split(text, ',');
    if (cells.size() != column.size())
      throw InputError(where + std::to_string(cells.size()) + " cells where the header has " +
                       std::to_string(column.size()));
    std::vector<double> point(campaign::contract().variables.size(), NAN);
    for (std::size_t k = 0; k < cells.size(); ++k) point[column[k]] = cell_value(cells[k], column[k], where);
    table.points.insert(table.points.end(), point.begin(), point.end());
    table.lines.push_back(text);
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

Json answer_question(const Predictor& predictor, const Question& question) {
  const auto& variables = question.variables;
  const bool joint_asked = question.reconstruct || question.outcome;
  const learning::JointAnswer joint =
      joint_asked ? predictor.reconstruct(variables, question.outcome) : learning::JointAnswer{};
  const learning::PosteriorAnswer answer = joint_asked ? joint.outcome : predictor.marginal(variables);
  Json json, given = Json::object(), unknown = Json::array(), outcomes = Json::object();
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const std::string& name = campaign::contract().variables[v].name;
    const bool has_it =
        !campaign::is_task_variable(campaign::contract().variables[v]) || predictor.model().sampled_upper[v] > 0;
    if (std::isnan(variables[v]) && !has_it) continue;
    if (std::isnan(variables[v]))
      unknown.push_back(name);
    else
      given[name] = variables[v];
  }
  double go = 0;
  for (std::size_t y = 0; y < answer.probability.size(); ++y) {
    Json entry;
    entry["probability"] = answer.probability[y];
    entry["standard_error"] = answer.standard_error[y];
    go += campaign::contract().outcomes[y].verdict != campaign::Verdict::no_go ? answer.probability[y] : 0;
    outcomes[campaign::contract().outcomes[y].name] = std::move(entry);
  }
  json[campaign::kGravityKey] = gravity_of(predictor.model());
  json["given"] = std::move(given);
  if (question.outcome) json["given_outcome"] = campaign::contract().outcomes[*question.outcome].name;
  json["summed_out"] = std::move(unknown);
  json["exact"] = answer.exact;
  json["p_go"] = go;
  json["outcomes"] = std::move(outcomes);
  json["outside_sampled"] = predictor.outside_variable(variables);
  json["novelty"] = predictor.novelty(variables);
  if (joint_asked) json["reconstruction"] = reconstruction_json(predictor, joint);
  return json;
}

std::string answer_text(const Json& answer) {
  std::string text;
  if (const Json* outcome = answer.find("given_outcome")) {
    text += "given that it ended " + outcome->string() + ":\n";
  } else {
    for (const auto& [name, entry] : answer.at("outcomes").members()) {
      const double p = entry.at("probability").number(), error = entry.at("standard_error").number();
      text += line(error > 0 ? "%-24s %.4f +- %.4f\n" : "%-24s %.4f\n", name.c_str(), p, error);
    }
    text += line("P(go or slow-go)         %.4f\n", answer.at("p_go").number());
  }
  if (const Json* found = answer.find("reconstruction"); found && !found->members().empty()) {
    text += line("%-24s %10s %10s   %s\n", "unknown", "mean", "deviation", "5 to 95 % within");
    for (const auto& [name, entry] : found->members())
      text += line("%-24s %10.4g %10.4g   %.4g to %.4g %s\n", name.c_str(), entry.at("mean").number(),
                   entry.at("deviation").number(), entry.at("low").number(), entry.at("high").number(),
                   entry.at("unit").string().c_str());
  }
  std::string summed;
  for (const Json& name : answer.at("summed_out").items()) summed += " " + name.string();
  if (!summed.empty()) text += "summed out:" + summed + (answer.at("exact").boolean() ? "\n" : " (by sampling)\n");
  const std::string& outside = answer.at("outside_sampled").string();
  if (!outside.empty())
    text += outside + " lies outside the range in which trials were made: do not trust this answer\n";
  text += line("gravity of the trials %.4g m/s2\n", answer.at(campaign::kGravityKey).number());
  return text +
         line("novelty %.2f (1: as near to a trial as trials are to one another)\n", answer.at("novelty").number());
}

std::size_t infer_csv(const Predictor& predictor, const std::filesystem::path& in, const std::filesystem::path& out) {
  const PointTable table = read_points(in);
  const std::size_t variables = campaign::contract().variables.size(), outcomes = campaign::contract().outcomes.size();
  std::vector<double> p(table.lines.size() * outcomes);
  predictor.outcome_probabilities(table.points, p);
  std::string text = table.header + ",p_go";
  for (const campaign::Outcome& outcome : campaign::contract().outcomes) text += "," + outcome.name;
  text += ",outside_sampled,novelty\n";
  for (std::size_t n = 0; n < table.lines.size(); ++n) {
    const auto point = std::span(table.points).subspan(n * variables, variables);
    double go = 0;
    std::string cells;
    for (std::size_t y = 0; y < outcomes; ++y) {
      if (campaign::contract().outcomes[y].verdict != campaign::Verdict::no_go) go += p[n * outcomes + y];
      cells += line(",%.6f", p[n * outcomes + y]);
    }
    text += table.lines[n] + line(",%.6f", go) + cells + "," + predictor.outside_variable(point) +
            line(",%.3f\n", predictor.novelty(point));
  }
  write_file_atomically(out, text);
  return table.lines.size();
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

}  // namespace gonogo::learn
