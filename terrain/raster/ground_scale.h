// Distances on the ground from longitude and latitude.
#pragma once
#include <array>

namespace gonogo::terrain {

/// Ground distance [m] between two near points {longitude, latitude} [deg] on the ellipsoid with semi-major axis a [m]
/// and inverse flattening 1/f. Radii of curvature at the middle latitude: M = a (1 - e2) / (1 - e2 sin2)^(3/2)
/// northward and N cos(lat), N = a / sqrt(1 - e2 sin2), eastward (Snyder, Map Projections, USGS PP 1395, eq. 4-18 to
/// 4-21).
double ground_distance(std::array<double, 2> from, std::array<double, 2> to, double semi_major,
                       double inverse_flattening);

}  // namespace gonogo::terrain
