// The trials of a table that to_csv() wrote.
#pragma once
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/campaign/dataset/row.h"

namespace gonogo::campaign {

inline std::vector<TrialRecord> csv_records(const std::string& csv) {
  std::vector<TrialRecord> records;
  std::istringstream lines(csv);
  std::string row;
  std::getline(lines, row);
  while (std::getline(lines, row)) records.push_back(parse_record(row).value());
  return records;
}

}  // namespace gonogo::campaign
