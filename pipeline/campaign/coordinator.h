// The local engine: trials computed by worker processes of this machine.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/trial/record.h"

namespace gonogo::pipeline {

struct PoolRequest {
  std::vector<const DesignPoint*> todo;
  std::vector<std::string> worker_command;  // program and arguments of a process that calls run_worker
  int workers = 1;
  std::function<void(TrialRecord)> finished;  // called in the order in which trials end
  std::function<void()> idle;                 // called several times a second
};

/// Computes every trial of `todo` and returns how many workers died on the way. A dead worker is replaced and its trial
/// done again; a trial whose workers crash twice, or are killed from outside five times, stops the campaign: it never
/// becomes a result, because results must not depend on which workers died. Throws InputError or DeviceError with the
/// worker's sentence when a trial reports trouble that all would meet, Cancelled on Ctrl-C. Workers never outlive this.
std::size_t compute_trials(const PoolRequest& request);

}  // namespace gonogo::pipeline
