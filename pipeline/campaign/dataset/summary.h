// A summary of a dataset: verdicts, ranges, agreement of replicates, and verdicts over slope.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/json/json.h"
#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

struct ValueRange {
  std::string name, unit;
  double minimum = kNaN, mean = kNaN, maximum = kNaN;  // over the rows that have a value; NaN when none has
};

using Counts = std::map<std::string, std::size_t>;  // of trials, by name of a verdict or reason

void count_outcome(const TrialRecord& record, Counts& by_verdict, Counts& by_reason);
/// "31 go, 12 no_go (7 traction, 5 sinkage)": counts for one line.
std::string counts_line(const Counts& by_verdict, const Counts& by_reason);
/// An object of numbers by name.
Json counts_json(const Counts& counts);

/// Trials of one interval of a variable.
struct SlopeBin {
  double from = 0, to = 0;  // [deg], closed at the left
  std::size_t go = 0, slow_go = 0, no_go = 0, unknown = 0;
};

struct DatasetSummary {
  std::size_t trials = 0, replicates = 0;
  Counts by_verdict, by_reason;  // every name of the contract that occurs
  std::vector<ValueRange> variables, measures;
  std::vector<std::pair<std::uint64_t, std::string>> failed;  // indices of unknown trials, checks that they failed
  std::size_t replicate_pairs = 0;                            // pairs of which both trials are valid
  std::size_t replicate_agree = 0;                            // of these, pairs that are both passable or both not
  std::vector<SlopeBin> slope;                                // over slope_along
};

DatasetSummary summarise(const std::vector<TrialRecord>& records);

std::string to_text(const DatasetSummary& summary);
Json to_json(const DatasetSummary& summary);

}  // namespace gonogo::campaign
