// One trial as one line of comma-separated values.
//   index,seed,replicate_of,proposal_density,<variables...>,verdict,reason,attempts,failed_checks,<measures...>
// Numbers have the fewest digits, at most 17, that read back to the same bits. NaN is "nan".
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/campaign/trial/record.h"

namespace gonogo::campaign {

std::vector<std::string> point_columns();
std::vector<std::string> record_columns();

/// Comma-separated, without the end of line.
std::string header_row();
std::string point_header_row();
std::string to_row(const DesignPoint& point);
std::string to_row(const TrialRecord& record);

/// The inverses. Empty for a line that is no such row: wrong number of columns, no number, unknown name.
std::optional<DesignPoint> parse_point(std::string_view row);
std::optional<TrialRecord> parse_record(std::string_view row);

}  // namespace gonogo::campaign
