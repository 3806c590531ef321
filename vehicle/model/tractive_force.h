// Tractive force of a vehicle's driveline at full throttle over the speed of its treads: closed forms of its file, of
// what engine, coupling and gears can push before any slip or resistance.
#pragma once
#include <functional>
#include <vector>

#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

/// Largest sum of forces at the driven treads [N], in the best gear, at this speed of the treads [m/s] >= 0. Driving is
/// steady, so that the inertia of engine and wheels takes nothing. 0 where every gear is past the engine's limit.
double tractive_force(const Vehicle& v, double tread_speed);

/// Tractive force in equal steps of speed, for many look-ups.
class TractiveForce {
 public:
  TractiveForce() = default;
  explicit TractiveForce(const Vehicle& v);

  /// [N] at a tread speed [m/s]; linear between the steps, 0 beyond top_speed().
  double at(double tread_speed) const;
  /// Tread speed from which on the driveline pushes no more [m/s].
  double top_speed() const { return step_ * double(force_.size() - 1); }
  /// Largest tread speed [m/s] at which the driveline gives `needed(tread speed)` [N]; 0 where it never does.
  double balance(const std::function<double(double)>& needed) const;

 private:
  double step_ = 0;            // [m/s]
  std::vector<double> force_;  // [N]
};

}  // namespace gonogo::vehicle
