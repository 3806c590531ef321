// Helpers of the hard-ground checks.
#pragma once
#include "vehicle/hard_ground/hard_ground.h"

namespace gonogo::vehicle {

std::unique_ptr<sim::Simulation> start(const HardGround& ground, const HardGroundRun& run, double step);

/// Advances by `time` [s], rounded to whole steps.
void drive_for(sim::Simulation& s, double time);

/// Speed of the chassis along x [m/s].
double forward_speed(sim::Simulation& s, const HardGround& ground);

}  // namespace gonogo::vehicle
