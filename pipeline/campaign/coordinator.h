// The local engine: trials computed by worker processes of this machine.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/trial/record.h"

namespace gonogo::pipeline {

struct PoolRequest {
  std::vector<const DesignPoint*> todo;
  /// Program and arguments of a process that calls run_worker, the `slot`-th of `workers` at a time.
  std::function<std::vector<std::string>(std::size_t slot)> worker_command;
  int workers = 1;
  int places = 1;                             // trials that a worker is given at a time
  std::function<void(TrialRecord)> finished;  // called in the order in which trials end
  std::function<void()> idle;                 // called several times a second
};

/// Computes every trial of `todo` and returns how many workers died on the way. A dead worker is replaced and its
/// trials done again; those of a worker that crashed, or was killed from outside for the second time, then get at most
/// half as many others beside them, until the one to blame is alone. A trial whose workers crash twice when it is
/// alone, or are killed five times, stops the campaign: it never becomes a result, because results must not depend on
/// which workers died. Throws InputError or DeviceError with the worker's sentence when a trial reports trouble that
/// all would meet, Cancelled on Ctrl-C. Workers never outlive this.
std::size_t compute_trials(const PoolRequest& request);

}  // namespace gonogo::pipeline
