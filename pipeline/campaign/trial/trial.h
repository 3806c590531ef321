// One trial: a driven wheel on a settled bed under tilted gravity, from design point to verdict.
#pragma once
#include <functional>
#include <span>

#include "base/units.h"
#include "pipeline/campaign/trial/record.h"
#include "pipeline/campaign/trial/setup.h"

namespace gonogo::campaign {

/// Settles and stores the packings that trials at these points need, so that workers find them. Safe to repeat.
void prepare_trials(const TrialSetup& setup, std::span<const DesignPoint> points, int threads);

/// Runs one trial on one thread. Pure: depends on setup and point alone. A simulation that fails a check is repeated
/// once with half the step; failing again it is `unknown`, never `no_go`. Throws only for bad input and missing
/// packings.
TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point);

/// Gravity in the frame of the bed (x along the heading, y left, z out of the bed) for slopes along and across it
/// [m/s^2]. The bed's normal leans by `s` from the vertical with tan^2 s = tan^2 along + tan^2 across. `gravity`: its
/// magnitude [m/s^2].
Vec3d bed_gravity(double slope_along_deg, double slope_across_deg, double gravity = kGravity);

/// State of a trial after a step, for observers. Numbers of the drive are NaN where the bed failed before there was a
/// wheel.
struct TrialSample {
  double time = 0;                   // from letting the wheel down [s]
  double x = kNaN;                   // travelled [m]
  double y = kNaN;                   // [m]
  double sinkage = kNaN;             // [m]
  double speed = kNaN;               // [m/s]
  double slip = kNaN;                // of the latest 0.25 s [-]
  double torque = kNaN;              // [N m]
  double residual = 0;               // root mean square over contacts [m/s]
  int contacts = 0, iterations = 0;  // of the step
};
using TrialObserver = std::function<void(const TrialSample&)>;

/// The bodies of a running trial, valid during the call.
struct TrialFrame {
  const TrialSample& sample;
  const sim::SceneWorld& world;  // shapes, masses and bounds; its bodies are where they were at the start
  sim::Simulation& simulation;   // now; only to be read
  sim::WorldIndex place;         // of this world in it
  sim::BodyIndex wheel;          // -1 when the bed failed before there was one
};

/// Observers of a trial. Watching does not change its bits.
struct TrialWatch {
  std::function<void()> start;                   // before each attempt: drop what an earlier one showed
  TrialObserver sample;                          // after every step
  std::function<void(const TrialFrame&)> frame;  // at the start, at intervals, and at the end
  double frame_interval = 0.02;                  // [s]
};

/// Where a trial saves itself while it drives, and how often.
struct TrialCheckpoint {
  std::filesystem::path path;  // empty: nowhere
  double every = 30;           // [s of the wall clock]
  /// Sets a file that cannot be used aside, with a line on stderr, and starts the trial from its beginning.
  bool set_aside = false;
};

/// Where a trial runs. On one backend its bits do not depend on the number of threads.
struct TrialDevice {
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;  // of the cpu backend
};

/// The same trial, watched and saved. Where `checkpoint` finds a file, the trial goes on from there to the same record.
/// The file is removed at the end. Ctrl-C saves and throws Cancelled. Throws InputError for a file of another trial.
TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point, const TrialWatch& watch,
                      const TrialCheckpoint& checkpoint = {}, const TrialDevice& device = {});

}  // namespace gonogo::campaign
