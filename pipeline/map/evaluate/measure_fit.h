// Expected measures (speed, slip, sinkage, energy per metre) of trials that passed, as a quadratic in each variable:
//
//   m(x) = c + sum_v (a_v z_v + b_v z_v^2),  z_v the variable scaled to [-1, 1] over the trials
//
// It is fitted by ridge regression. The ridge parameter minimises the leave-one-out error (Golub, Heath, Wahba 1979).
// The fit has no cross terms because a few dozen trials do not determine them. Without them an unknown variable can be
// replaced by its mean over the trials.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/heading.h"

namespace gonogo::map {

/// Lower bound on the expected speed in route costs [m/s]. It keeps the time finite.
inline constexpr double kMinSpeed = 0.05;

struct MeasureFit {
  std::string name, unit;
  std::vector<double> middle, half_width;  // [variables] z = (x - middle) / half_width; half_width 0: did not vary
  std::vector<double> linear, quadratic;   // [variables]
  std::vector<double> mean_z, mean_z2;     // [variables] over the trials, for unknown variables
  double constant = 0;
  double lowest = 0, highest = 0;  // range seen in the trials; SlopeMeasure is clamped to it
  double error = 0, spread = 0;    // leave-one-out RMSE; standard deviation [unit]
  std::size_t trials = 0;

  /// m(x) [unit], not clamped. NaN marks an unknown variable.
  double value(std::span<const double> variables) const;
};

/// points: [rows x variables], row by row. value: [rows]; rows with NaN are left out. Fewer than 12 rows give a
/// constant.
MeasureFit fit_measure(std::string name, std::string unit, std::span<const double> points,
                       std::span<const double> value);

/// A measure on one soil as a function of the slopes along and across the heading [deg].
struct SlopeMeasure {
  double base = 0, along = 0, along2 = 0, across = 0, across2 = 0, lowest = 0, highest = 0;
  double at(BedSlopes slopes) const;
};

/// Mean of the fit over the points that the soil may be. The slopes in `points` are ignored.
SlopeMeasure on_soil(const MeasureFit& fit, const std::vector<std::vector<double>>& points);

}  // namespace gonogo::map
