// Datasets checked, compared and put together.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/json/json.h"
#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

/// Faults that no campaign writes, one sentence each. Empty: the dataset is sound. Checked are:
///   indices: each once, increasing;
///   replicates: of an earlier trial, with its variables;
///   variables: inside the ranges of the contract;
///   outcomes: verdict and reason belong together, valid trials have measures, attempts are 1 or 2.
std::vector<std::string> faults_of(const Dataset& dataset);

struct RowDifference {
  std::uint64_t index = 0;
  std::string column;
  std::string first, second;  // as in the dataset's CSV
};

struct DatasetDifference {
  std::vector<std::string> provenance;                 // what differs, with both values
  std::vector<std::uint64_t> only_first, only_second;  // indices of trials
  std::vector<RowDifference> rows;                     // of trials that both have
  std::size_t common = 0;                              // trials that both have
  bool none() const { return provenance.empty() && only_first.empty() && only_second.empty() && rows.empty(); }
};

/// Compares bit for bit. One NaN equals another.
DatasetDifference difference(const Dataset& first, const Dataset& second);
std::string to_text(const DatasetDifference& difference);

/// Trials of several datasets of one study as one dataset, each trial once, in the order of the design. The study's
/// number of points may differ. `names` are the files, for messages. Throws InputError when trials depend on different
/// inputs or one trial has two results. Different inputs include another design: proposal densities of two designs do
/// not add up to one.
Dataset merge_datasets(const std::vector<Dataset>& parts, const std::vector<std::string>& names);

/// Second less first, over the pairs that both pass and have the measure.
struct MeasureChange {
  std::string name, unit;
  std::size_t pairs = 0;
  double mean = kNaN;   // [unit]
  double error = kNaN;  // standard error of the mean [unit]; NaN for fewer than two pairs
};

/// Two datasets of the same points, trial by trial: which verdicts differ, and how far measures move. What one changed
/// setting does to a study is seen so with far fewer trials than from two averages.
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
