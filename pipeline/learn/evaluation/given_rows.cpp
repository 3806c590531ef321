#include "pipeline/learn/evaluation/given_rows.h"

#include <algorithm>
#include <cmath>

#include "base/csv.h"
#include "base/error.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::learn {
namespace {

std::size_t outcome_of(const std::filesystem::path& file, std::size_t number, const std::string& cell) {
  const auto& outcomes = campaign::contract().outcomes;
  const auto found =
      std::find_if(outcomes.begin(), outcomes.end(), [&](const auto& outcome) { return outcome.name == cell; });
  if (found == outcomes.end())
    refuse_csv_line(file, number, "\"" + cell + "\" is no outcome; give one as go or no_go/traction");
  return std::size_t(found - outcomes.begin());
}

/// Position of a variable in the contract, or its size for a column that is none.
std::size_t variable_of(const std::string& name) {
  const auto& variables = campaign::contract().variables;
  return std::size_t(std::find_if(variables.begin(), variables.end(), [&](const auto& v) { return v.name == name; }) -
                     variables.begin());
}

}  // namespace

learning::TrainingTable read_given_rows(const std::filesystem::path& file) {
  const std::vector<CsvLine> lines = read_csv_lines(file, "rows");
  const std::vector<std::string> header = lines.front().cells();
  if (std::find(header.begin(), header.end(), "outcome") == header.end())
    throw InputError(file.string() + ": its header has no column \"outcome\"");
  learning::TrainingTable table;
  table.variable_count = campaign::contract().variables.size();
  for (std::size_t n = 1; n < lines.size(); ++n) {
    const std::size_t number = lines[n].number;
    const std::vector<std::string> cells = lines[n].cells();
    if (cells.size() != header.size())
      refuse_csv_line(file, number,
                      "has " + std::to_string(cells.size()) + " columns, the header " + std::to_string(header.size()));
    std::vector<double> values(table.variable_count, NAN);
    double weight = 1;
    std::size_t outcome = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::size_t variable = variable_of(header[k]);
      if (variable < values.size()) values[variable] = csv_number(file, number, cells[k]);
      if (header[k] == "outcome") outcome = outcome_of(file, number, cells[k]);
      if (header[k] == "weight" || header[k] == "occurrences") weight *= csv_number(file, number, cells[k]);
    }
    if (weight < 0) refuse_csv_line(file, number, "a weight is at least 0");
    if (weight == 0) continue;
    table.variables.insert(table.variables.end(), values.begin(), values.end());
    table.outcome.push_back(outcome);
    table.weight.push_back(weight);
    table.group.push_back(n);
  }
  if (table.row_count() == 0) throw InputError(file.string() + ": holds a header and no rows");
  return table;
}

}  // namespace gonogo::learn
