// A moving patch against a fixed bed so long that the vehicle never leaves it: the same virgin ground, the same
// driving.
#pragma once
#include <filesystem>

#include "base/json/json.h"
#include "pipeline/validate/trials.h"

namespace gonogo::pipeline {

struct PatchRequest {
  std::filesystem::path vehicle, calibration;
  double slope = 10, friction_angle = 0;  // 0: the middle of what the grains reach [deg]
  double speed = 1.5, distance = 8;       // [m/s], [m]
  int seeds = 4;
  /// Of the solver in every step. Its tolerance is not used: it is a mean over the contacts of a world, which a longer
  /// bed at rest meets sooner, so that beds of two lengths would be solved to two accuracies near the wheel.
  int iterations = 60;
  BatchSettings batch;
};

/// Means over the seeds, on the same ground.
struct PatchReport {
  MeanOf slip[2], sinkage[2];                  // moving patch, fixed bed; over the last half of the driving [-], [m]
  MeanOf slip_difference, sinkage_difference;  // of a seed's two trials
  std::size_t grains[2] = {};
  double cost[2][2] = {};  // contact-iterations per metre over the first and the second half of the way, each bed
  double length[2] = {};   // of the bed [m]
  int passed = 0;          // of trials, neither unknown nor no_go

  /// Difference over the fixed bed's value.
  double slip_deviation() const { return slip_difference.mean / slip[1].mean; }
  double sinkage_deviation() const { return sinkage_difference.mean / sinkage[1].mean; }
};

PatchReport compare_patch(const PatchRequest& request);

Json as_json(const PatchReport& r);
std::string as_text(const PatchReport& r);

}  // namespace gonogo::pipeline
