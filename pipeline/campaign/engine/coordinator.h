// Hands trials out to a crew of workers and hears their records.
#pragma once
#include <functional>
#include <vector>

#include "pipeline/campaign/engine/crew.h"
#include "pipeline/campaign/trial/record.h"

namespace gonogo::campaign {

struct PoolRequest {
  std::vector<const DesignPoint*> todo;
  Crew* crew = nullptr;
  int places = 1;                             // trials that a worker is given at a time
  std::function<void(TrialRecord)> finished;  // called in the order in which trials end
  std::function<void()> idle;                 // called several times a second
};

/// Computes every trial of `todo` and returns how many workers died. A dead worker is replaced and its trials are done
/// again.
///
/// The trial that kills workers is found by halving: after a crash, or a second kill from outside, the trials that the
/// worker had get at most half as many others beside them. A trial whose workers crash twice while it is alone, or are
/// killed five times, stops the campaign. It never becomes a result: results must not depend on which workers died.
///
/// Throws InputError or DeviceError with the worker's sentence when a trial reports a fault that all would meet. Throws
/// InputError for a worker of another version of the program, Cancelled on Ctrl-C.
std::size_t compute_trials(const PoolRequest& request);

}  // namespace gonogo::campaign
