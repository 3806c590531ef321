// How the checks on hard ground run a world.
#pragma once
#include "vehicle/hard_ground/hard_ground.h"

namespace gonogo::vehicle {

std::unique_ptr<sim::Simulation> start(const HardGround& ground, const HardGroundRun& run, double step);

/// Advances by a time, in whole steps [s].
void drive_for(sim::Simulation& s, double time);

/// Of the chassis along x [m/s].
double forward_speed(sim::Simulation& s, const HardGround& ground);

}  // namespace gonogo::vehicle
