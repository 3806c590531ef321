// What is measured and judged at the ends of a trial's phases.
#pragma once
#include <string>
#include <vector>

#include "pipeline/campaign/setup/record.h"
#include "pipeline/campaign/trial/world.h"

namespace gonogo::campaign {

/// A wheel of the vehicle and the monitor that watches it.
struct WatchedWheel {
  std::string name;
  Index monitor = 0;
  double radius = 0;  // [m]
  bool driven = true, sinks = true;
};

std::vector<WatchedWheel> watched_wheels(const TrialSetup& setup);

/// How many of them touch the ground: sinkage is their mean.
double sinking(const std::vector<WatchedWheel>& wheels);

/// Verdict and measures of a drive. Measures stand in the contract's order and units.
struct DriveOutcome {
  Verdict verdict = Verdict::unknown;
  Reason reason = Reason::simulation_failed;
  // 0 before the driving began; NaN of a bed that failed by itself, except for distance, time and speed.
  double distance = 0, drive_time = 0, mean_speed = 0, slip = 0, sinkage = 0, drift = 0, mean_torque = 0,
         energy_per_metre = 0;
  double towed_pull = kNaN, towed_side = kNaN;  // of a wheel that a carriage tows, over its load; else NaN
  double bed_creep = 0, worst_residual = 0, energy_error = 0;
  Index flags = 0;                  // sim::StepFlag
  std::vector<WheelRecord> wheels;  // of a whole vehicle
  std::vector<PullPoint> pull;      // of a drawbar sweep
};

/// Measures and verdict of a drive whose monitor has stopped the world.
DriveOutcome judge_drive(const TrialSetup& setup, const TrialConditions& conditions, const TiltedBed& bed, double step,
                         sim::Simulation& simulation, sim::WorldIndex world);

DriveOutcome outcome_of_failed_bed(const TiltedBed& bed);

/// Bits of the checks that the simulation failed; its outcome counts when there are none.
std::uint64_t failed_checks(const TrialSetup& setup, const DriveOutcome& o);
void store_measures(const DriveOutcome& o, TrialRecord& record);

}  // namespace gonogo::campaign
