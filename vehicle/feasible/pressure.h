// Where the contact forces press on a plane: the centre of pressure of the normal forces, which is the zero-moment
// point (Vukobratovic & Borovac 2004).
#pragma once
#include <optional>
#include <vector>

#include "base/vec.h"

namespace gonogo::vehicle {

struct Pressure {
  double x = 0, y = 0;  // [m]
  double edge = 0;      // distance inside the nearest edge of the contacts' convex hull; negative: beyond that edge [m]
};

/// Of normal forces whose sum is not 0 at points of a plane; z is left out. None where the hull has no area.
std::optional<Pressure> centre_of_pressure(const std::vector<Vec3d>& point, const std::vector<double>& normal);

}  // namespace gonogo::vehicle
