// Virtual simple-shear test in a doubly periodic cell: a rough plate of glued grains, loaded from above, is dragged
// across a settled packing at constant speed. Shear stress over normal stress gives the friction angle and cohesion.
#pragma once
#include "terrain/bed/bed.h"

namespace gonogo::terrain {

struct ShearSettings {
  double normal_stress = 10e3;  // [Pa]
  double speed = 0.15;          // of the plate [m/s]
  double settle_time = 0.3;     // under load before the plate moves [s]
  double travel = 4;            // of the plate, in grain diameters
  double step = 1e-3;           // [s]
  int iterations = 200;         // most per step
  double tolerance = 2e-3;      // residual at which the solver stops [m/s]
};

struct ShearResult {
  double shear_stress;    // mean over the travel after half a diameter [Pa]
  double normal_stress;   // carried by the bed, same average [Pa]
  double scatter;         // standard error of the shear stress [Pa]
  double dilation;        // rise of the plate over the travel [m]
  double worst_residual;  // largest root-mean-square residual [m/s]
};

/// Cell in which shear tests run: ten by six grains, eight deep.
BedSpec shear_cell(double grain_diameter, double settle_friction, std::uint64_t seed);

ShearResult shear_test(const Packing& cell, const BedLaws& laws, const ShearSettings& settings);

}  // namespace gonogo::terrain
