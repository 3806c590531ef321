// Closed forms from a vehicle's file: weights, wheel loads, tyres' compliance, gear speeds, tractive force.
#pragma once
#include <functional>
#include <vector>

#include "vehicle/model/assembly.h"

namespace gonogo::vehicle {

struct Weights {
  double total = 0;     // [kg]
  double unsprung = 0;  // wheels, uprights and half of the arms; tracks [kg]
  Vec3d centre;         // of mass, in the vehicle's frame [m]
  double ground = 0;    // z of the ground under the wheels in the design position [m]
};

Weights weigh(const Vehicle& v);

/// Normal loads of the stations' wheels on level ground [N]. More than three wheels are statically indeterminate: equal
/// springs under a rigid vehicle are assumed, so that the load is linear in x and y.
std::vector<double> static_loads(const Vehicle& v);

/// Length of ground contact of a track, first to last road wheel [m].
double track_contact_length(const Vehicle& v);

/// Load over nominal contact area of each station [Pa]. The area is tyre width times radius (NRMM's contact pressure
/// factor), or shoe width times the station's share of the contact length.
std::vector<double> contact_pressures(const Vehicle& v);

struct GearSpeed {
  double ratio = 0;           // engine speed over wheel speed
  double cut = 0;             // speed at the engine's limit [m/s]
  double balanced = 0;        // speed at which full throttle gives no torque [m/s]
  double tractive_force = 0;  // largest, at the driven wheels' radius, stalled converter [N]
};

/// Forward gears, lowest first.
std::vector<GearSpeed> gear_speeds(const Vehicle& v);

/// Largest sum of drive torques at all driven wheels or sprockets, in the lowest gear [N m].
double largest_drive_torque(const Vehicle& v);

/// Torque to the driven axle i of n, in the order of the file, over that behind the gearbox: an open centre
/// differential shares by `front_share` between two axles, and equally among more.
double torque_share(const Driveline& d, std::size_t i, std::size_t n);

/// Distance from the driven axle to the line of the ground force: wheel or sprocket radius [m].
double drive_radius(const Vehicle& v);

/// Width of the tread that grains are counted across: of the first wheel, or of a track's shoe [m].
double tread_width(const Vehicle& v);

/// Contact of a compliant tyre and a grain, along its normal. The springs of a static footprint together have the
/// stiffness of the tyre: a cylinder of width b pressed by d into a foundation of stiffness c per area carries
/// 4/3 c b d sqrt(2 r d). The load W shall be carried at d = W / k, k the stiffness of the tyre. A grain of diameter D
/// covers the area D^2, so that
///   k_contact = 3/4 k D^2 / (b sqrt(2 r W / k)),  at most k.
LinearSpring contact_spring(const Wheel& w, double load, double grain_diameter);

/// Tractive force at full throttle, which engine, coupling and gears can push before any slip or resistance: largest
/// sum of forces at the driven treads [N], in the best gear, at this speed of the treads [m/s] >= 0. Driving is steady,
/// so that the inertia of engine and wheels takes nothing. 0 where every gear is past the engine's limit.
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
  using Need = std::function<double(double)>;  // [N] at a tread speed [m/s]
  /// Largest tread speed [m/s] at which the driveline gives `needed`; 0 where it never does. `least`: no more than
  /// `needed` at any speed, and nowhere falling; spares the search the speeds for which it is too much already.
  double balance(
      const Need& needed, const Need& least = [](double) { return 0.0; }) const;

 private:
  double step_ = 0;              // [m/s]
  std::vector<double> force_;    // [N]
  std::vector<double> largest_;  // of force_ from here on [N]
};

}  // namespace gonogo::vehicle
