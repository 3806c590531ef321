// The physical part of a trial: tilt the bed, let the wheel down, drive, watch, judge.
#pragma once
#include "pipeline/trial/trial.h"

namespace gonogo::pipeline {

struct TrialConditions {
  Vec3 gravity;  // in the frame of the bed [m/s^2]
  terrain::BedLaws laws;
  double payload = 0;  // of the whole vehicle [kg]
  double speed = 1;    // commanded rim speed [m/s]
};

/// Verdict and measures (units in the contract). When the bed failed before the vehicle acted, driving measures are
/// NaN.
struct DriveOutcome {
  Verdict verdict = Verdict::unknown;
  Reason reason = Reason::simulation_failed;
  double distance, drive_time, mean_speed, slip, sinkage, drift, mean_torque, energy_per_metre;
  double bed_creep = 0, worst_residual = 0, energy_error = 0;
  Index flags = 0;
};

/// `attempt`: 1, or 2 with half the step and twice the iterations.
DriveOutcome drive(const TrialSetup& setup, const terrain::Packing& packing, const TrialConditions& conditions,
                   std::uint64_t attempt, const TrialWatch& watch, const TrialCheckpoint& checkpoint);

}  // namespace gonogo::pipeline
