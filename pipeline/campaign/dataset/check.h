// Datasets checked, compared and put together.
#pragma once
#include <string>
#include <vector>

#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

/// One sentence for each thing that no campaign writes: indices that repeat or do not increase, replicates of no
/// earlier trial or of other variables, values outside the contract's ranges, verdicts with reasons that do not belong
/// to them, valid trials without measures, attempts that are neither 1 nor 2. Empty: the dataset is sound.
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

/// Compares bit for bit; not-a-numbers are equal.
DatasetDifference difference(const Dataset& first, const Dataset& second);
std::string to_text(const DatasetDifference& difference);

/// Trials of several datasets of one study as one, in the order of the design, each once. The study's number of points
/// may differ. Throws InputError when trials depend on different things (proposal densities of different designs do not
/// add up to one), and when one trial has two results; `names` are the files, for the message.
Dataset merge_datasets(const std::vector<Dataset>& parts, const std::vector<std::string>& names);

}  // namespace gonogo::campaign
