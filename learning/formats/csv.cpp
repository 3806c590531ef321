// Answers as a table: a header of labels or ids, one row of values per line, with energies and counts.
#include <map>
#include <span>

#include "base/files/csv.h"
#include "learning/formats/format.h"
#include "learning/qubo/json.h"
#include "learning/qubo/text.h"

namespace gonogo::learning {
namespace {

/// Column of each label, of "energy" and of "num_occurrences"; -1 where absent.
struct Columns {
  std::vector<std::ptrdiff_t> variable;
  std::ptrdiff_t energy = -1, occurrences = -1;
  std::size_t count = 0;
};

Columns read_csv_header(const CsvLine& header, const Problem& problem, const std::string& source) {
  const auto fail = [&](const std::string& what) { refuse_csv_line(source, header.number, what); };
  std::map<std::string, std::ptrdiff_t> place;
  for (std::size_t k = 0; k < header.cell.size(); ++k)
    if (!place.emplace(header.cell[k], std::ptrdiff_t(k)).second) fail("column " + header.cell[k] + " appears twice");
  Columns columns;
  columns.count = header.cell.size();
  for (const Label& label : problem.labels) {
    const auto found = place.find(label_text(label));
    if (found == place.end()) fail("no column for variable " + label_text(label));
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
  if (!place.empty()) fail("column " + place.begin()->first + " is no variable of the problem");
  return columns;
}

SampleSet samples_from_csv(const std::string& text, const Problem& problem, const std::string& source) {
  const std::vector<CsvLine> lines = csv_lines(text, source, "header with the variables' labels");
  const Columns columns = read_csv_header(lines.front(), problem, source);
  SampleSet samples{.vartype = problem.vartype, .labels = problem.labels};
  const int off = problem.vartype == Vartype::binary ? 0 : -1;
  for (const CsvLine& line : std::span(lines).subspan(1)) {
    const auto fail = [&](const std::string& what) { refuse_csv_line(source, line.number, what); };
    const auto number = [&](std::ptrdiff_t k) { return csv_number(source, line.number, line.cell[std::size_t(k)]); };
    if (line.cell.size() != columns.count)
      fail(std::to_string(line.cell.size()) + " values where the header has " + std::to_string(columns.count));
    const std::size_t first = samples.values.size();
    for (std::ptrdiff_t column : columns.variable) {
      const double value = number(column);
      if (value != off && value != 1)
        fail("value " + line.cell[std::size_t(column)] + " is neither " + std::to_string(off) + " nor 1");
      samples.values.push_back(std::int8_t(value));
    }
    const std::span<const std::int8_t> values = std::span(samples.values).subspan(first);
    samples.energies.push_back(columns.energy < 0 ? energy(problem, values) : number(columns.energy));
    const double count = columns.occurrences < 0 ? 1 : number(columns.occurrences);
    if (count < 1 || count > 1e15 || count != double(std::int64_t(count)))
      fail("num_occurrences must be a whole number from 1 on");
    samples.occurrences.push_back(std::int64_t(count));
  }
  return samples;
}

}  // namespace

std::string samples_csv(const SampleSet& samples) {
  std::vector<std::string> header;
  for (const Label& label : samples.labels) header.push_back(label_text(label));
  header.insert(header.end(), {"energy", "num_occurrences"});
  std::string text = csv_row(header) + "\n";
  for (std::size_t r = 0; r < samples.row_count(); ++r) {
    for (std::int8_t value : samples.row(r)) text += std::to_string(int(value)) + ",";
    text += python_number(samples.energies[r]) + "," + std::to_string(samples.occurrences[r]) + "\n";
  }
  return text;
}

extern const Format kCsv = {.name = "csv", .about = "table of rows", .read_answer = samples_from_csv};

}  // namespace gonogo::learning
