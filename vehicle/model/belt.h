// Way of a track around its wheels.
#pragma once
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

struct Circle {
  double x = 0, z = 0, radius = 0;  // [m]
};

/// Length of the shortest closed belt around circles [m]: the boundary of their convex hull.
double convex_belt_length(const std::vector<Circle>& circles);

/// Length of a track's line of pins [m]; `tension` 0: idler where it is drawn, 1: at the end of its travel.
double belt_length(const Vehicle& v, bool left, double tension);

}  // namespace gonogo::vehicle
