// The closed line of pins of a track in the vehicle's middle plane (x, z), pin to pin one pitch apart.
#pragma once
#include <string>

#include "vehicle/model/belt.h"

namespace gonogo::vehicle {

struct TrackLoop {
  std::vector<Vec3d> pin;  // [shoe] in the track's middle plane, y = 0; counted from the foremost up and backwards [m]
  double tension = 0;      // share of the tensioner's travel at which the loop closes, within [0, 1]
  Vec3d idler;             // where the idler then is [m]
  double tooth_angle = 0;  // about the sprocket's axle from x to z, of a tooth [rad]
};

/// Teeth of the sprocket: of the circle through the pins, whose chords are pitches.
int sprocket_teeth(const Track& t);

/// Distance that a shoe's way takes per radian of the sprocket: teeth times pitch over a turn [m]. A little less than
/// the radius of the pins, because belts go around in chords.
double rolling_radius(const Track& t);

/// Smallest distance of pins from the axle of a wheel of this radius at which no plate cuts into it [m].
double pin_circle(const Track& t, double wheel_radius);

/// By chords of one pitch along the convex hull of the circles that pins keep around sprocket, idler and road wheels,
/// with the idler where the last chord ends at the first pin. Throws InputError, beginning with the vehicle's name, for
/// shoes that do not close within the tensioner's travel.
TrackLoop close_loop(const Vehicle& v, bool left);

/// Throws InputError for a sprocket whose pins' circle holds no whole number of pitches.
void check_sprocket(const Track& t, const std::string& where);

/// The vehicle with its trailing arms turned down to where their springs carry it, as far as its belts allow; springs,
/// clearance and arms stay what they are. Vehicles without tracks stay as they are.
Vehicle set_down(Vehicle v);

}  // namespace gonogo::vehicle
