#include "pipeline/lab/bench/timing.h"

#include <algorithm>
#include <chrono>

namespace gonogo::lab {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

double seconds_per_step(sim::Simulation& simulation, int repeats, int steps_per_sample) {
  std::vector<double> samples;
  for (int k = 0; k < repeats; ++k) {
    const double start = seconds();
    simulation.advance(steps_per_sample);  // returns when the device has finished
    samples.push_back((seconds() - start) / steps_per_sample);
  }
  return median(samples);
}

}  // namespace gonogo::lab
