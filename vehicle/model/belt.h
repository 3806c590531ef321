// Path of a track around its wheels, as the convex hull of circles.
#pragma once
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

struct Circle {
  double x = 0, z = 0, radius = 0;  // [m]
};

/// An arc of the convex hull of circles: the interval of directions [rad] in which `circle` is the farthest.
struct HullArc {
  std::size_t circle = 0;
  double from = 0, to = 0;  // angle from x towards z; 0 <= from < to <= 2 pi
};
/// All arcs, sorted by direction. A circle may have several arcs, or none.
std::vector<HullArc> hull_arcs(const std::vector<Circle>& circles);

/// Length of the shortest closed belt around circles [m]: the boundary of their convex hull.
double convex_belt_length(const std::vector<Circle>& circles);

/// Length of a track's line of pins [m]. `tension` 0: idler in its design position; 1: at the end of its travel.
double belt_length(const Vehicle& v, bool left, double tension);

}  // namespace gonogo::vehicle
