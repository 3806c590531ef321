// Summary of drawn rows, and their files.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/json/json.h"
#include "pipeline/outcome/sampling/sample_rows.h"

namespace gonogo::outcome {

struct RowsReport {
  std::size_t rows = 0, chains = 0;
  RowSource from = RowSource::machine;
  std::string sampler;
  bool independent = false;
  std::uint64_t seed = 0;
  std::vector<std::pair<std::string, double>> known;             // [unit of the variable]
  std::string known_outcome;                                     // empty: none
  double p_go = 0;                                               // share of the rows that pass
  std::vector<std::pair<std::string, double>> outcomes;          // shares
  std::vector<std::pair<std::string, learning::Mixing>> mixing;  // of what was drawn
  double largest_r_hat = 0, least_effective_rows = 0;            // NaN where nothing was drawn
  std::optional<bool> mixed;
};

RowsReport rows_report(const Predictor& predictor, const RowRequest& request, const SampledRows& rows);
Json to_json(const RowsReport& report);
std::string rows_text(const RowsReport& report);

/// Rows as a file by its extension: .csv has a column for each variable and one for the outcome. .h5 has "variables"
/// [row x variable], "outcome" [row], "chain" [row] and their names and units. Throws InputError for another extension.
void write_rows(const std::filesystem::path& path, const Predictor& predictor, const SampledRows& rows,
                const RowsReport& report);

}  // namespace gonogo::outcome
