// Expected measures (speed, slip, sinkage, energy per metre) of trials that passed, as a quadratic in each variable:
//
//   m(x) = c + sum_v (a_v z_v + b_v z_v^2),  z_v the variable scaled to [-1, 1] over the trials
//
// fitted by ridge regression; the ridge with the least leave-one-out error is taken (Golub, Heath, Wahba 1979).
// Additive on purpose: a few dozen trials do not determine more, and an unknown variable is replaced by its mean over
// the trials.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/heading.h"

namespace gonogo::map {

/// Routes never count on less speed than this [m/s].
inline constexpr double kSlowestSpeed = 0.05;

struct MeasureFit {
  std::string name, unit;
  std::vector<double> middle, half_width;  // [variables] scaling; half width 0 for a variable that did not vary
  std::vector<double> linear, quadratic;   // [variables]
  std::vector<double> mean_z, mean_z2;     // [variables] over the trials, for unknown variables
  double constant = 0;
  double lowest = 0, highest = 0;  // seen in the trials; values are kept between them
  double error = 0, spread = 0;    // leave-one-out rmse; standard deviation of the measure [unit]
  std::size_t trials = 0;

  /// Without the limits; not-a-number marks an unknown variable.
  double value(std::span<const double> variables) const;
};

/// points: [rows x variables] row by row, value: [rows]; rows whose value is not-a-number are left out. Fewer than 12
/// rows give a constant.
MeasureFit fit_measure(std::string name, std::string unit, std::span<const double> points,
                       std::span<const double> value);

/// A measure on one soil as a function of the slopes along and across the heading [deg].
struct SlopeMeasure {
  double base = 0, along = 0, along2 = 0, across = 0, across2 = 0, lowest = 0, highest = 0;
  double at(BedSlopes slopes) const;
};

/// Mean over the points that the soil may be; slopes in `points` are not looked at.
SlopeMeasure on_soil(const MeasureFit& fit, const std::vector<std::vector<double>>& points);

}  // namespace gonogo::map
