// Weighted least-squares lines through measured points, with standard errors.
#pragma once
#include <vector>

#include "base/mean_error.h"

namespace gonogo::terrain {

struct LineFit {
  double intercept = 0, slope = 0;
  double intercept_error = 0, slope_error = 0;  // standard errors, from the scatter about the line
  double r2 = 0;                                // share of the variance of y that the line explains
};

/// y = intercept + slope x. Empty `weight`: equal weights. Needs three points at two values of x. Standard errors as in
/// Press et al., Numerical Recipes, section 15.2, with the variance estimated from the residuals.
LineFit fit_line(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& weight = {});

/// An angle from its tangent or sine, with its standard error [deg].
struct Angle {
  double degrees = 0, error = 0;
};
Angle angle_of_tangent(double tangent, double error);
Angle angle_of_sine(double sine, double error);

}  // namespace gonogo::terrain
