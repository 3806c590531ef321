// A trial of a dataset computed again, from what the dataset holds alone.
#pragma once
#include <string>
#include <vector>

#include "pipeline/campaign/dataset/check.h"

namespace gonogo::campaign {

struct Replay {
  TrialRecord record;
  std::vector<RowDifference> differences;  // of the record against the dataset's, bit for bit
  bool same_program = true;                // as the one that made the dataset
};

/// Writes study, vehicle and soil as the dataset stores them to a folder of its own, settles the bed that the trial
/// needs and computes the trial on the dataset's kind of device. Throws InputError for a trial that is not there, a
/// dataset without the files its trials depend on (made before they were stored) and a device that is not here.
Replay replay_trial(const Dataset& dataset, std::uint64_t index, int threads);

}  // namespace gonogo::campaign
