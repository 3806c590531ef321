// Trials as text: one as a line of comma-separated values, a dataset as a table for other programs.
//   index,seed,replicate_of,proposal_density,<variables...>,verdict,reason,attempts,failed_checks,<measures...>
// Variables and measures of some trials alone (contract.h) stand only in tables of trials that have them: all or none.
// Numbers have the fewest digits, at most 17, that read back to the same bits. NaN is "nan".
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/setup/record.h"

namespace gonogo::campaign {

/// `with_task`: with the variables and measures of some trials alone.
std::vector<std::string> point_columns(bool with_task);
std::vector<std::string> record_columns(bool with_task);

/// Comma-separated, without the end of line.
std::string point_header_row(bool with_task);
/// With the columns of some trials alone where one of them is set.
std::string to_row(const DesignPoint& point);
std::string to_row(const TrialRecord& record);

/// Whether it, or any of them, sets a variable or has a measure of some trials alone.
bool has_task_values(const TrialRecord& record);
bool has_task_values(const std::vector<TrialRecord>& records);

/// The inverses. Empty for a line that is no such row: wrong number of columns, no number, unknown name.
std::optional<DesignPoint> parse_point(std::string_view row);
std::optional<TrialRecord> parse_record(std::string_view row);

/// Header and one line per trial.
std::string to_csv(const Dataset& dataset);

/// One JSON object: "provenance", "units", and "trials", an object per trial. NaN is null.
std::string to_json_text(const Dataset& dataset);

}  // namespace gonogo::campaign
