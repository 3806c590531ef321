// One trial: a driven wheel on a settled bed under tilted gravity, from design point to verdict.
#pragma once
#include <functional>
#include <span>

#include "pipeline/trial/record.h"
#include "pipeline/trial/setup.h"

namespace gonogo::pipeline {

/// Settles and stores the packings that trials at these points need, so that workers find them. Safe to repeat.
void prepare_trials(const TrialSetup& setup, std::span<const DesignPoint> points, int threads);

/// Runs one trial on one thread. Pure: depends on setup and point alone. A simulation that fails a check is repeated
/// once with half the step; failing again it is `unknown`, never `no_go`. Throws only for bad input and missing
/// packings.
TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point);

/// Gravity in the frame of the bed (x along the heading, y left, z out of the bed) for slopes along and across it
/// [m/s^2]. The bed's normal leans by `s` from the vertical with tan^2 s = tan^2 along + tan^2 across.
Vec3d bed_gravity(double slope_along_deg, double slope_across_deg);

/// State of a trial after each `sample` steps, for people who look.
struct TrialSample {
  double time, x, y, sinkage, speed, slip, torque, residual;
  int contacts, iterations;
};
using TrialObserver = std::function<void(const TrialSample&)>;

/// Same trial, watched: the observer changes nothing.
TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point, const TrialObserver& observe);

}  // namespace gonogo::pipeline
