#include "vehicle/model/statics.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.h"

namespace gonogo::vehicle {
namespace {

/// Bottom of a wheel: the tread, of a road wheel the track under it [m].
double bottom(const Vehicle& v, const Station& s) {
  const double below = v.kind == VehicleKind::tracked ? v.track->pad_above_pin + v.track->pad_below_pin : 0;
  return s.centre.z - s.wheel->radius - below;
}

double unsprung_mass(const Vehicle& v) {
  double sum = 0;
  for (const Station& s : stations(v)) {
    sum += s.wheel->part.mass + 0.5 * s.suspension->tie_rod_mass;
    for (const auto& [name, part] : s.suspension->part) sum += (name == "upright" ? 1 : 0.5) * part.mass;
  }
  if (v.track) sum += v.track->shoe_mass * (v.track->left_shoes + v.track->right_shoes);
  return sum;
}

/// Speed at which a torque curve falls to zero, or its last [rad/s].
double balance_speed(const Curve& torque) {
  for (std::size_t i = torque.at.size() - 1; i > 0; --i)
    if (torque.value[i - 1] > 0 && torque.value[i] <= 0)
      return torque.at[i - 1] +
             (torque.at[i] - torque.at[i - 1]) * torque.value[i - 1] / (torque.value[i - 1] - torque.value[i]);
  return torque.at.back();
}

int driven_wheels(const Vehicle& v) {
  if (v.kind == VehicleKind::tracked) return 2;
  int count = 0;
  for (const Station& s : stations(v)) count += s.driven;
  return count;
}

double gear_ratio(const Driveline& d, double gear) { return 1 / (gear * d.final_drive); }

double engine_torque(const Driveline& d) {
  const double peak = *std::max_element(d.engine.value.begin(), d.engine.value.end());
  return d.converter.empty() ? peak : peak * *std::max_element(d.converter.value.begin(), d.converter.value.end());
}

constexpr int kTableSteps = 2048;  // of TractiveForce

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

Weights weigh(const Vehicle& v) {
  Weights w;
  for (const Part& p : assemble(v).body) {
    w.total += p.mass;
    w.centre += p.mass * p.centre;
  }
  w.centre *= 1 / w.total;
  w.unsprung = unsprung_mass(v);
  w.ground = std::numeric_limits<double>::infinity();
  for (const Station& s : stations(v)) w.ground = std::min(w.ground, bottom(v, s));
  return w;
}

std::vector<double> static_loads(const Vehicle& v) {
  const auto wheels = stations(v);
  const Weights w = weigh(v);
  Eigen::MatrixXd balance(3, wheels.size());
  for (std::size_t i = 0; i < wheels.size(); ++i)
    balance.col(Eigen::Index(i)) << 1, wheels[i].centre.x - w.centre.x, wheels[i].centre.y - w.centre.y;
  const Eigen::VectorXd weight = w.total * kGravity * Eigen::VectorXd::Unit(3, 0);
  const Eigen::VectorXd load = balance.completeOrthogonalDecomposition().solve(weight);
  return {load.begin(), load.end()};
}

double track_contact_length(const Vehicle& v) {
  const auto& x = v.track->road_wheel_x;
  return *std::max_element(x.begin(), x.end()) - *std::min_element(x.begin(), x.end());
}

std::vector<double> contact_pressures(const Vehicle& v) {
  const auto wheels = stations(v);
  const std::size_t per_track = wheels.size() / 2;
  std::vector<double> result = static_loads(v);
  for (std::size_t i = 0; i < wheels.size(); ++i)
    result[i] /= v.kind == VehicleKind::tracked ? v.track->shoe_width * track_contact_length(v) / double(per_track)
                                                : wheels[i].wheel->width * wheels[i].wheel->radius;
  return result;
}

double torque_share(const Driveline& d, std::size_t i, std::size_t n) {
  if (n == 2) return i == 0 ? d.front_share : 1 - d.front_share;
  return 1.0 / double(n);
}

double drive_radius(const Vehicle& v) {
  if (v.kind == VehicleKind::tracked) return v.track->sprocket_radius;
  for (const Station& s : stations(v))
    if (s.driven) return s.wheel->radius;
  return 0;
}

double largest_drive_torque(const Vehicle& v) {
  const Driveline& d = v.driveline;
  if (d.wheel_motors) return d.efficiency * engine_torque(d) * driven_wheels(v);
  return d.efficiency * engine_torque(d) * gear_ratio(d, *std::min_element(d.gears.begin(), d.gears.end()));
}

std::vector<GearSpeed> gear_speeds(const Vehicle& v) {
  const Driveline& d = v.driveline;
  const double radius = drive_radius(v);
  std::vector<double> gears = d.gears;
  std::sort(gears.begin(), gears.end());
  std::vector<GearSpeed> result;
  for (const double gear : gears) {
    GearSpeed g;
    g.ratio = d.wheel_motors ? 1 : gear_ratio(d, gear);
    g.cut = d.cut_speed / g.ratio * radius;
    g.balanced = std::min(balance_speed(d.engine), d.cut_speed) / g.ratio * radius;
    g.tractive_force = largest_drive_torque(v) / radius * g.ratio / (d.wheel_motors ? 1 : gear_ratio(d, gears[0]));
    result.push_back(g);
  }
  return result;
}

double tread_width(const Vehicle& v) { return v.track ? v.track->shoe_width : v.wheel.front().width; }

LinearSpring contact_spring(const Wheel& w, double load, double grain_diameter) {
  const LinearSpring& tyre = w.compliant;
  const double half = std::sqrt(2 * w.radius * load / tyre.stiffness);
  const double share = std::min(1.0, 0.75 * grain_diameter * grain_diameter / (w.width * half));
  return {share * tyre.stiffness, share * tyre.damping};
}

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
  step_ = top / kTableSteps;
  for (int i = 0; i <= kTableSteps; ++i) force_.push_back(tractive_force(v, i * step_));
  largest_ = force_;
  for (std::size_t i = largest_.size() - 1; i > 0; --i) largest_[i - 1] = std::max(largest_[i - 1], largest_[i]);
}

double TractiveForce::at(double tread_speed) const {
  const double place = tread_speed / step_;
  const auto below = std::size_t(place);
  if (below + 1 >= force_.size()) return below + 1 == force_.size() && place == double(below) ? force_.back() : 0;
  return force_[below] + (place - double(below)) * (force_[below + 1] - force_[below]);
}

double TractiveForce::balance(const Need& needed, const Need& least) const {
  const auto spare = [&](double speed) { return at(speed) - needed(speed); };
  if (spare(top_speed()) >= 0) return top_speed();
  std::size_t enough = 0, i = force_.size() - 1;  // a step where a faster one might be enough, and one where none is
  while (i - enough > 1) {
    const std::size_t middle = (enough + i) / 2;
    (largest_[middle] >= least(double(middle) * step_) ? enough : i) = middle;
  }
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
