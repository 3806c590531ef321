// Times of steps.
#pragma once
#include <vector>

#include "sim/simulation/simulation.h"

namespace gonogo::lab {

/// Wall clock [s].
double seconds();

double median(std::vector<double> values);

/// Median time of a step, each of `repeats` samples taken over `steps_per_sample` steps that nothing interrupts [s].
double seconds_per_step(sim::Simulation& simulation, int repeats, int steps_per_sample);

}  // namespace gonogo::lab
