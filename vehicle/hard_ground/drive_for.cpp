#include "vehicle/hard_ground/drive_for.h"

#include <cmath>

#include "base/error.h"

namespace gonogo::vehicle {

std::unique_ptr<sim::Simulation> start(const HardGround& ground, const HardGroundRun& run, double step) {
  sim::StepSettings settings;
  settings.iterations = 50;
  settings.step = Real(step);
  return sim::make_simulation(run.backend, sim::Scene{ground.world}, settings, run.threads);
}

void drive_for(sim::Simulation& s, double time) {
  s.advance(Index(std::lround(time / s.settings().step)));
  const sim::StepReport report = s.report(0);
  if (report.flags != 0)
    throw DeviceError("a vehicle on hard ground failed: " + sim::description(report.fault, s.settings().step));
}

double forward_speed(sim::Simulation& s, const HardGround& ground) { return s.body(0, ground.e.chassis).velocity.x; }

}  // namespace gonogo::vehicle
