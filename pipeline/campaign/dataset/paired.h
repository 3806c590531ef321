// Two datasets of the same points, trial by trial: which verdicts differ, and how far measures move. What one changed
// setting does to a study is seen so with far fewer trials than from two averages.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/json/json.h"
#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

/// Second less first, over the pairs that both pass and have the measure.
struct MeasureChange {
  std::string name, unit;
  std::size_t pairs = 0;
  double mean = kNaN;   // [unit]
  double error = kNaN;  // standard error of the mean [unit]; NaN for fewer than two pairs
};

struct PairedTrials {
  std::size_t pairs = 0;  // trials of one index and the same variables, both valid
  std::map<std::pair<std::string, std::string>, std::size_t> verdicts;  // names (first, second) -> pairs
  std::size_t now_pass = 0, now_fail = 0;  // pairs of which only the second, or only the first, passes
  std::vector<MeasureChange> measures;     // all of the contract
};

PairedTrials paired(const Dataset& first, const Dataset& second);

/// Nothing without pairs.
std::string to_text(const PairedTrials& paired);
Json to_json(const PairedTrials& paired);

}  // namespace gonogo::campaign
