#include "terrain/raster/ground_scale.h"

#include <cmath>

#include "base/units.h"

namespace gonogo::terrain {

double ground_distance(std::array<double, 2> from, std::array<double, 2> to, double semi_major,
                       double inverse_flattening) {
  const double f = inverse_flattening > 0 ? 1 / inverse_flattening : 0, e2 = f * (2 - f);
  const double latitude = (from[1] + to[1]) / 2 * kDegree, sine = std::sin(latitude), w2 = 1 - e2 * sine * sine;
  const double east = std::remainder(to[0] - from[0], 360.0) * kDegree, north = (to[1] - from[1]) * kDegree;
  return semi_major * std::hypot(north * (1 - e2) / (w2 * std::sqrt(w2)), east * std::cos(latitude) / std::sqrt(w2));
}

}  // namespace gonogo::terrain
