#include "pipeline/learn/qubo/decode_answer.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"

namespace gonogo::learn {
namespace {

/// Column of the answer for each visible unit; -1 for units of clamped variables, which the problem does not hold.
std::vector<std::ptrdiff_t> unit_columns(const Sidecar& sidecar, const learning::SampleSet& answer) {
  std::map<std::string, std::ptrdiff_t> column;
  for (std::size_t k = 0; k < answer.labels.size(); ++k)
    column[learning::label_text(answer.labels[k])] = std::ptrdiff_t(k);
  std::vector<std::ptrdiff_t> result;
  for (const std::string& label : sidecar.layout.unit_labels()) {
    const auto found = column.find(label);
    result.push_back(found == column.end() ? -1 : found->second);
  }
  return result;
}

/// Code words of clamped variables stand in for the units that were taken out.
std::vector<learning::Bit> clamped_row(const Sidecar& sidecar) {
  std::vector<learning::Bit> row(sidecar.layout.unit_count(), 0);
  for (const auto& [name, value] : sidecar.clamped) {
    const std::size_t v = sidecar.layout.variable_index(name);
    const learning::Encoder& encoder = sidecar.layout.encoders()[v];
    encoder.encode(encoder.bin_of(value), std::span(row).subspan(sidecar.layout.offset(v), encoder.unit_count()));
  }
  return row;
}

}  // namespace

DecodedAnswer decode_answer(const Sidecar& sidecar, const learning::SampleSet& answer, learning::DecodeRule rule) {
  const std::vector<std::ptrdiff_t> column = unit_columns(sidecar, answer);
  std::vector<learning::Bit> row = clamped_row(sidecar);
  DecodedAnswer result;
  for (std::size_t r = 0; r < answer.row_count(); ++r) {
    for (std::size_t i = 0; i < column.size(); ++i)
      if (column[i] >= 0) row[i] = answer.row(r)[std::size_t(column[i])] > 0;
    const learning::DecodedRow decoded = sidecar.layout.decode(row, rule);
    result.reads += double(answer.occurrences[r]);
    const bool complete =
        std::none_of(decoded.values.begin(), decoded.values.end(), [](double x) { return std::isnan(x); });
    if (!complete || !decoded.outcome) continue;
    (decoded.valid ? result.valid : result.repaired) += double(answer.occurrences[r]);
    DecodedAnswer::Row item{decoded.values, *decoded.outcome, answer.energies[r], answer.occurrences[r]};
    for (const auto& [name, value] : sidecar.clamped) item.values[sidecar.layout.variable_index(name)] = value;
    result.rows.push_back(std::move(item));
  }
  return result;
}

std::string rows_csv(const Sidecar& sidecar, const DecodedAnswer& decoded) {
  std::string text;
  for (const learning::Encoder& encoder : sidecar.layout.encoders()) text += encoder.name() + ",";
  text += "outcome,energy,occurrences\n";
  for (const DecodedAnswer::Row& row : decoded.rows) {
    for (double x : row.values) text += Json(x).dump() + ",";
    text += sidecar.layout.outcomes()[row.outcome] + "," + Json(row.energy).dump() + "," +
            std::to_string(row.occurrences) + "\n";
  }
  return text;
}

Json summary_json(const Sidecar& sidecar, const DecodedAnswer& decoded) {
  Json json, outcomes = Json::object(), variables = Json::object();
  json["reads"] = decoded.reads;
  json["valid"] = decoded.valid;
  json["repaired"] = decoded.repaired;
  json["invalid_share"] = decoded.reads > 0 ? 1 - decoded.valid / decoded.reads : 0;
  const double used = decoded.valid + decoded.repaired;
  std::vector<double> count(sidecar.layout.outcome_count(), 0.0);
  for (const auto& row : decoded.rows) count[row.outcome] += double(row.occurrences);
  for (std::size_t y = 0; y < count.size() && used > 0; ++y) {
    const double share = count[y] / used;
    Json entry;
    entry["frequency"] = share;
    entry["standard_error"] = std::sqrt(share * (1 - share) / used);
    outcomes[sidecar.layout.outcomes()[y]] = std::move(entry);
  }
  for (std::size_t v = 0; v < sidecar.layout.variable_count() && used > 0; ++v) {
    double mean = 0, square = 0;
    for (const auto& row : decoded.rows) mean += double(row.occurrences) * row.values[v] / used;
    for (const auto& row : decoded.rows)
      square += double(row.occurrences) * (row.values[v] - mean) * (row.values[v] - mean) / used;
    Json entry;
    entry["unit"] = sidecar.layout.encoders()[v].unit();
    entry["mean"] = mean;
    entry["standard_deviation"] = std::sqrt(square);
    variables[sidecar.layout.encoders()[v].name()] = std::move(entry);
  }
  json["outcomes"] = std::move(outcomes);
  json["variables"] = std::move(variables);
  return json;
}

}  // namespace gonogo::learn
