// A bed at rest under its own weight: vertical stress in its contacts against the weight above, level by level.
#pragma once
#include "terrain/soil_test/test_run.h"

namespace gonogo::terrain {

struct GeostaticSample {
  double depth;           // below the surface [m]
  double stress, weight;  // vertical stress in contacts; weight above over area [Pa]
};

struct GeostaticResult {
  std::vector<GeostaticSample> profile;  // one per grain diameter, from the surface to the base
  double worst_error = 0;                // max of |stress / weight - 1| below the upper two grains [-]
  double solid_fraction = 0;
};

/// `grains_deep` diameters of soil on a periodic cell of ten by six.
GeostaticResult geostatic_test(const TestSoil& soil, double grains_deep, const TestPace& pace);

}  // namespace gonogo::terrain
