// Closed forms from a vehicle's file: weights, wheel loads, gear speeds.
#pragma once
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

/// Distance from the driven axle to the line of the ground force: wheel or sprocket radius [m].
double drive_radius(const Vehicle& v);

/// Width of the tread that grains are counted across: of the first wheel, or of a track's shoe [m].
double tread_width(const Vehicle& v);

}  // namespace gonogo::vehicle
