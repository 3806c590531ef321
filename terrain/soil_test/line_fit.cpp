#include "terrain/soil_test/line_fit.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/units.h"

namespace gonogo::terrain {
namespace {}  // namespace

LineFit fit_line(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& weight) {
  GONOGO_ASSERT(x.size() == y.size() && (weight.empty() || weight.size() == x.size()));
  const auto w = [&](std::size_t i) { return weight.empty() ? 1.0 : weight[i]; };
  double sum = 0, mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += w(i);
    mean_x += w(i) * x[i];
    mean_y += w(i) * y[i];
  }
  mean_x /= sum;
  mean_y /= sum;
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - mean_x, dy = y[i] - mean_y;
    xx += w(i) * dx * dx;
    xy += w(i) * dx * dy;
    yy += w(i) * dy * dy;
  }
  LineFit f;
  f.slope = xy / xx;
  f.intercept = mean_y - f.slope * mean_x;
  const double left = std::max(0.0, yy - f.slope * xy);
  f.r2 = yy > 0 ? 1 - left / yy : 1;
  if (x.size() > 2) {
    const double variance = left / double(x.size() - 2);
    f.slope_error = std::sqrt(variance / xx);
    f.intercept_error = std::sqrt(variance * (1 / sum + mean_x * mean_x / xx));
  }
  return f;
}

Angle angle_of_tangent(double tangent, double error) {
  return {std::atan(tangent) / kDegree, error / (1 + tangent * tangent) / kDegree};
}

Angle angle_of_sine(double sine, double error) {
  const double s = std::clamp(sine, -1.0, 1.0);
  return {std::asin(s) / kDegree, error / std::sqrt(std::max(1e-12, 1 - s * s)) / kDegree};
}

}  // namespace gonogo::terrain
