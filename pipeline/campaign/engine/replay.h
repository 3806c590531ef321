// Repeats one trial of a dataset from the dataset alone.
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

/// Writes the stored study, vehicle and soil to a temporary folder, settles the bed and computes the trial on the
/// dataset's kind of device. Throws InputError for a trial that is not there and for a device that this machine lacks.
/// Datasets made before input files were stored cannot be replayed and throw InputError too.
Replay replay_trial(const Dataset& dataset, std::uint64_t index, int threads);

}  // namespace gonogo::campaign
