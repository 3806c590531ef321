// Slip of each second of a drive, to see whether a run was long enough.
#pragma once
#include "pipeline/campaign/trial/trial.h"

namespace gonogo::lab {

/// Places of a trial's wheel at the end of each second of its driving [m], from its observer. Must stay where it is
/// while it watches.
struct Way {
  double from = 0;  // park time [s]
  std::vector<double> x;

  campaign::TrialWatch watch() {
    campaign::TrialWatch w;
    w.start = [this] { x.clear(); };
    w.sample = [this](const campaign::TrialSample& s) {
      if (s.time >= from + double(x.size()) - 1e-9) x.push_back(s.x);
    };
    return w;
  }
};

/// Mean over the trials, of each second that all have driven. `speed`: of the circle at which slip counts [m/s].
std::vector<double> slip_over_time(const std::vector<Way>& ways, double speed);

}  // namespace gonogo::lab
