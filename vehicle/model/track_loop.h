// Path of a track around its wheels: the convex hull of circles, and on it the closed polygon of pins in the plane
// (x, z), one pitch between neighbours.
#pragma once
#include <string>

#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

struct Circle {
  double x = 0, z = 0, radius = 0;  // [m]
};

/// Length of the shortest closed belt around circles [m]: the boundary of their convex hull.
double convex_belt_length(const std::vector<Circle>& circles);

/// Length of a track's line of pins [m]. `tension` 0: idler in its design position; 1: at the end of its travel.
double belt_length(const Vehicle& v, bool left, double tension);

struct TrackLoop {
  std::vector<Vec3d> pin;  // [shoe] in the track's middle plane, y = 0, from the foremost pin up and backwards [m]
  double tension = 0;      // share of the tensioner's travel at which the loop closes, within [0, 1]
  Vec3d idler;             // position of the idler then [m]
  double tooth_angle = 0;  // of one tooth about the sprocket's axle, from x towards z [rad]
};

/// Number of teeth: of pitches that fit as chords into the circle through the pins.
int sprocket_teeth(const Track& t);

/// Distance that the belt moves per radian of the sprocket: teeth times pitch over 2 pi [m]. It is a little less than
/// the radius of the pins, because the belt runs in chords.
double rolling_radius(const Track& t);

/// Distance of the pins from the axle of a wheel of this radius whose surface the plates just touch [m].
double pin_circle(const Track& t, double wheel_radius);

/// Places pins by chords of one pitch along the convex hull of the pin circles of sprocket, idler and road wheels. The
/// idler moves until the last chord ends at the first pin. Throws InputError, which begins with the vehicle's name,
/// when the loop does not close within the tensioner's travel.
TrackLoop close_loop(const Vehicle& v, bool left);

/// Throws InputError unless the circle through the sprocket's pins holds a whole number of pitches.
void check_sprocket(const Track& t, const std::string& where);

/// A tracked vehicle with its trailing arms turned down until their springs carry it, as far as the belts allow.
/// Springs, clearance and arms do not change. Other vehicles are returned unchanged.
Vehicle set_down(Vehicle v);

}  // namespace gonogo::vehicle
