// Answers as a table: a header of labels or ids, one row of values per line, with energies and counts.
#include <map>

#include "base/error.h"
#include "learning/formats/format.h"
#include "learning/qubo/json.h"
#include "learning/qubo/text.h"

namespace gonogo::learning {
namespace {

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

Columns read_csv_header(const TextLines& lines, const Problem& problem) {
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
  const Columns columns = read_csv_header(lines, problem);
  SampleSet samples{.vartype = problem.vartype, .labels = problem.labels};
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

}  // namespace

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

extern const Format kCsv = {.name = "csv", .about = "table of rows", .read_answer = samples_from_csv};

}  // namespace gonogo::learning
