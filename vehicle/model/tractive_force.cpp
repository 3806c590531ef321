#include "vehicle/model/tractive_force.h"

#include <algorithm>
#include <cmath>

#include "vehicle/model/assembly.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

constexpr int kSteps = 2048;

int driven_wheels(const Vehicle& v) {
  int count = 0;
  for (const Station& s : stations(v)) count += s.driven;
  return v.kind == VehicleKind::tracked ? 2 : count;
}

/// Torque behind a converter whose turbine turns at `turbine` [rad/s]: the engine settles where it gives the torque
/// that the converter takes, capacity(ratio) times its speed squared.
double converter_torque(const Driveline& d, double turbine) {
  double low = std::max(turbine, 1e-6), high = std::max(d.cut_speed, low);
  for (int i = 0; i < 60; ++i) {
    const double engine = (low + high) / 2;
    const bool takes_less = d.converter_capacity(turbine / engine) * engine * engine < d.engine(engine);
    (takes_less ? low : high) = engine;
  }
  return d.converter(turbine / low) * d.engine(low);
}

/// Torque into the gearbox, whose input shaft turns at `shaft` [rad/s].
double gearbox_torque(const Driveline& d, double shaft) {
  if (!d.converter_capacity.empty()) return converter_torque(d, shaft);
  if (d.clutch_torque > 0) return std::min(d.clutch_torque, d.engine(std::max(shaft, d.engaged_speed)));
  return d.engine(shaft);
}

}  // namespace

double tractive_force(const Vehicle& v, double tread_speed) {
  const Driveline& d = v.driveline;
  const double radius = drive_radius(v), turns = tread_speed / radius;
  if (d.wheel_motors) {
    if (turns > d.cut_speed) return 0;
    return std::max(0.0, d.efficiency * d.engine(turns) * driven_wheels(v) / radius);
  }
  double best = 0;
  for (const double gear : d.gears) {
    const double ratio = 1 / (gear * d.final_drive), shaft = turns * ratio;
    if (shaft <= d.cut_speed) best = std::max(best, d.efficiency * gearbox_torque(d, shaft) * ratio / radius);
  }
  return best;
}

TractiveForce::TractiveForce(const Vehicle& v) {
  double top = 0;
  for (const GearSpeed& g : gear_speeds(v)) top = std::max(top, g.balanced);
  step_ = top / kSteps;
  for (int i = 0; i <= kSteps; ++i) force_.push_back(tractive_force(v, i * step_));
}

double TractiveForce::at(double tread_speed) const {
  const double place = tread_speed / step_;
  const auto below = std::size_t(place);
  if (below + 1 >= force_.size()) return below + 1 == force_.size() && place == double(below) ? force_.back() : 0;
  return force_[below] + (place - double(below)) * (force_[below + 1] - force_[below]);
}

double TractiveForce::balance(const std::function<double(double)>& needed) const {
  const auto spare = [&](double speed) { return at(speed) - needed(speed); };
  std::size_t i = force_.size() - 1;
  if (spare(double(i) * step_) >= 0) return top_speed();
  while (i > 0 && spare(double(i - 1) * step_) < 0) --i;
  if (i == 0) return 0;
  double low = double(i - 1) * step_, high = double(i) * step_;
  for (int k = 0; k < 40; ++k) {
    const double middle = (low + high) / 2;
    (spare(middle) >= 0 ? low : high) = middle;
  }
  return low;
}

}  // namespace gonogo::vehicle
