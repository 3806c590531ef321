// The conditions that a design point sets in the simulation.
#pragma once
#include "pipeline/campaign/trial/record.h"
#include "pipeline/campaign/trial/setup.h"

namespace gonogo::campaign {

struct TrialConditions {
  Vec3 gravity;  // in the frame of the bed [m/s^2]
  terrain::BedLaws laws;
  std::optional<sim::PairLaw> soft;  // between grains of a strip of softer soil
  double payload = 0;                // of the whole vehicle [kg]
  double speed = 1;                  // commanded rim speed [m/s]
};

/// Throws InputError for a soil that the calibration does not reach.
TrialConditions conditions_of(const TrialSetup& setup, const DesignPoint& point);

/// The packing on which the trial drives, before it is shifted.
terrain::BedSpec bed_spec_of(const TrialSetup& setup, const DesignPoint& point);

/// The settled bed of the trial, from the cache or else settled now.
terrain::Packing settled_bed(const TrialSetup& setup, const DesignPoint& point);

/// Numerics of an attempt: those of the setup for 1; for 2 half the step, so twice the iterations per simulated time.
terrain::Numerics attempt_numerics(const TrialSetup& setup, std::uint64_t attempt);
sim::StepSettings attempt_settings(const TrialSetup& setup, std::uint64_t attempt);

}  // namespace gonogo::campaign
