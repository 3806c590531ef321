// Way of a track around its wheels.
#pragma once
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

struct Circle {
  double x = 0, z = 0, radius = 0;  // [m]
};

/// A part of the boundary of circles' convex hull: the directions [rad] in which a circle reaches furthest.
struct HullArc {
  std::size_t circle = 0;
  double from = 0, to = 0;  // from x to z; 0 <= from < to <= 2 pi
};
/// All of them, by direction; a circle may have several, one that is not on the hull none.
std::vector<HullArc> hull_arcs(const std::vector<Circle>& circles);

/// Length of the shortest closed belt around circles [m]: the boundary of their convex hull.
double convex_belt_length(const std::vector<Circle>& circles);

/// Length of a track's line of pins [m]; `tension` 0: idler where it is drawn, 1: at the end of its travel.
double belt_length(const Vehicle& v, bool left, double tension);

}  // namespace gonogo::vehicle
