// Where a campaign computes its trials: the study's section "compute", overridden by the command line.
#pragma once
#include <optional>
#include <string>

#include "pipeline/campaign/study/study.h"
#include "sim/simulation/simulation.h"

namespace gonogo::campaign {

struct ComputeRequest {
  std::optional<std::string> device;  // "cpu" or "cuda"
  std::optional<int> places, workers;
  std::optional<double> checkpoint_every;  // [s]
  int threads = 0;                         // 0: one per core
};

struct ComputeSettings {
  sim::Backend device = sim::Backend::cpu;
  std::string backend = "cpu";  // as results name it: "cpu", or "cuda" and the name of the devices
  int places = 1;               // trials that a worker computes side by side
  int workers = 1;
  int gpus = 0;                  // that the workers share; 0 for the cpu
  double checkpoint_every = 30;  // running trials are saved [s of the wall clock]; 0: never
  int threads = 1;               // for what the host does itself
};

/// Throws InputError for numbers out of range, and for a device that this build or machine lacks.
ComputeSettings read_compute(const Study& study, const ComputeRequest& request);

}  // namespace gonogo::campaign
