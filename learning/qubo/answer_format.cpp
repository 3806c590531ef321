#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "learning/qubo/dimod.h"
#include "learning/qubo/foreign_file.h"
#include "learning/qubo/format.h"
#include "learning/qubo/python_json.h"
#include "learning/qubo/qbsolv.h"
#include "learning/qubo/text_lines.h"

namespace gonogo::learning {
namespace {

constexpr std::array<const char*, 4> kNames = {"dimod_json", "sapi", "qbsolv", "csv"};

std::string without_blanks(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// Cells between commas. Within quotes a comma belongs to the cell, and two quotes are one.
std::vector<std::string> cells(std::string_view line) {
  std::vector<std::string> result;
  std::string cell;
  bool quoted = false, was_quoted = false;
  const auto end_cell = [&] {
    result.push_back(was_quoted ? cell : without_blanks(cell));
    cell.clear();
    was_quoted = false;
  };
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (quoted && line[k] == '"' && k + 1 < line.size() && line[k + 1] == '"') {
      cell += line[k++];
    } else if (line[k] == '"' && (quoted || without_blanks(cell).empty())) {
      quoted = !quoted;
      if (quoted) cell.clear();
      was_quoted = true;
    } else if (line[k] == ',' && !quoted) {
      end_cell();
    } else if (!(was_quoted && !quoted && line[k] == ' ')) {
      cell += line[k];
    }
  }
  end_cell();
  return result;
}

/// A cell of a CSV file, in quotes where it needs them.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos && without_blanks(text) == text) return text;
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string(2, c) : std::string(1, c);
  return quoted + "\"";
}

/// Column of each label, of "energy" and of "num_occurrences"; -1 where absent.
struct Columns {
  std::vector<std::ptrdiff_t> variable;
  std::ptrdiff_t energy = -1, occurrences = -1;
  std::size_t count = 0;
};

Columns read_header(const TextLines& lines, const Problem& problem) {
  const std::vector<std::string> names = cells(lines.line());
  std::map<std::string, std::ptrdiff_t> place;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (!place.emplace(names[k], std::ptrdiff_t(k)).second) lines.fail("column " + names[k] + " appears twice");
  Columns columns;
  columns.count = names.size();
  for (const Label& label : problem.labels) {
    const auto found = place.find(label_text(label));
    if (found == place.end()) lines.fail("no column for variable " + label_text(label));
    columns.variable.push_back(found->second);
    place.erase(found);
  }
  if (const auto found = place.find("energy"); found != place.end()) {
    columns.energy = found->second;
    place.erase(found);
  }
  if (const auto found = place.find("num_occurrences"); found != place.end()) {
    columns.occurrences = found->second;
    place.erase(found);
  }
  if (!place.empty()) lines.fail("column " + place.begin()->first + " is no variable of the problem");
  return columns;
}

double cell_number(const TextLines& lines, const std::string& cell) {
  double value = 0;
  if (!parse_number(cell, value)) lines.fail("expected a finite number, found \"" + cell + "\"");
  return value;
}

SampleSet samples_from_csv(const std::string& text, const Problem& problem, const std::string& source) {
  TextLines lines(text, source);
  if (!lines.next()) throw InputError(source + ": no header with the variables' labels");
  const Columns columns = read_header(lines, problem);
  SampleSet samples;
  samples.vartype = problem.vartype;
  samples.labels = problem.labels;
  const int off = problem.vartype == Vartype::binary ? 0 : -1;
  while (lines.next()) {
    const std::vector<std::string> row = cells(lines.line());
    if (row.size() != columns.count)
      lines.fail(std::to_string(row.size()) + " values where the header has " + std::to_string(columns.count));
    const std::size_t first = samples.values.size();
    for (std::ptrdiff_t column : columns.variable) {
      const double value = cell_number(lines, row[std::size_t(column)]);
      if (value != off && value != 1)
        lines.fail("value " + row[std::size_t(column)] + " is neither " + std::to_string(off) + " nor 1");
      samples.values.push_back(std::int8_t(value));
    }
    const std::span<const std::int8_t> values = std::span(samples.values).subspan(first);
    samples.energies.push_back(columns.energy < 0 ? energy(problem, values)
                                                  : cell_number(lines, row[std::size_t(columns.energy)]));
    const double count = columns.occurrences < 0 ? 1 : cell_number(lines, row[std::size_t(columns.occurrences)]);
    if (count < 1 || count > 1e15 || count != double(std::int64_t(count)))
      lines.fail("num_occurrences must be a whole number from 1 on");
    samples.occurrences.push_back(std::int64_t(count));
  }
  return samples;
}

/// SAPI serves energies without the problem's offset, which D-Wave's client adds on its side; saved answers may be of
/// either kind. The first row tells which; check_answer() verifies all.
SampleSet with_offset(SampleSet answer, const Problem& problem) {
  if (answer.row_count() == 0 || problem.offset == 0) return answer;
  std::map<Label, std::int8_t> value;
  for (std::size_t k = 0; k < answer.variable_count(); ++k) value[answer.labels[k]] = answer.row(0)[k];
  std::vector<std::int8_t> row;
  for (const Label& label : problem.labels) {
    const auto found = value.find(label);
    if (found == value.end()) return answer;  // another problem's: check_answer() says so
    row.push_back(found->second);
  }
  const double gap = energy(problem, row) - answer.energies.front();
  if (std::abs(gap - problem.offset) < std::abs(gap))
    for (double& e : answer.energies) e += problem.offset;
  return answer;
}

}  // namespace

std::string answer_format_names() {
  std::string names;
  for (const char* name : kNames) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

AnswerFormat answer_format_named(const std::string& name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end())
    throw InputError("answer format \"" + name + "\" does not exist; use one of " + answer_format_names());
  return AnswerFormat(found - kNames.begin());
}

std::string samples_csv(const SampleSet& samples) {
  std::string text;
  for (const Label& label : samples.labels) text += csv_cell(label_text(label)) + ",";
  text += "energy,num_occurrences\n";
  for (std::size_t r = 0; r < samples.row_count(); ++r) {
    for (std::int8_t value : samples.row(r)) text += std::to_string(int(value)) + ",";
    text += python_number(samples.energies[r]) + "," + std::to_string(samples.occurrences[r]) + "\n";
  }
  return text;
}

SampleSet read_answer(const std::string& text, AnswerFormat format, const Problem& problem, const std::string& source) {
  refuse_foreign_file(text, source);
  switch (format) {
    case AnswerFormat::dimod_json:
      return samples_from_dimod_json(text, source);
    case AnswerFormat::sapi:
      return with_offset(samples_from_sapi(text, source), problem);
    case AnswerFormat::qbsolv:
      return samples_from_qbsolv(text, problem, source);
    default:
      return samples_from_csv(text, problem, source);
  }
}

}  // namespace gonogo::learning
