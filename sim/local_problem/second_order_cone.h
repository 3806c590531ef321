// A Lorentz cone { x_0 >= |(x_1, x_2)| } as an interior point method sees it: scaling by Nesterov & Todd (1997), Jordan
// product, step to the boundary. A smaller cone leaves x_2, or x_1 and x_2, at 0. Inside sim/local_problem.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace gonogo::sim {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Numbers are near 1, so that squares neither overflow nor vanish before they matter.
inline double tail_length(const Vector3d& x) { return std::sqrt(x[1] * x[1] + x[2] * x[2]); }

/// x_0^2 - |x_1|^2 as a product, which cancels less; positive inside the cone.
inline double cone_determinant(const Vector3d& x) { return (x[0] - tail_length(x)) * (x[0] + tail_length(x)); }

/// The symmetric w with w z = w^-1 s, s and z inside the cone (Andersen, Roos, Terlaky 2003): eta times the hyperbolic
/// rotation along the unit axis.
struct NesterovTodd {
  Matrix3d w, inverse;

  NesterovTodd(const Vector3d& s, const Vector3d& z) {
    const double root_s = std::sqrt(cone_determinant(s)), root_z = std::sqrt(cone_determinant(z));
    const Vector3d a = s / root_s, b = z / root_z;
    const double gamma = std::sqrt((1 + b.dot(a)) / 2), eta = std::sqrt(root_s / root_z);
    const Vector3d axis = (a + Vector3d(b[0], -b[1], -b[2])) / (2 * gamma);
    w = eta * rotation(axis);
    inverse = rotation(Vector3d(axis[0], -axis[1], -axis[2])) / eta;
  }

 private:
  static Matrix3d rotation(const Vector3d& axis) {
    Matrix3d m = Matrix3d::Identity() + axis * axis.transpose() / (1 + axis[0]);
    m.row(0) = axis.transpose();
    m.col(0) = axis;
    return m;
  }
};

inline Vector3d jordan_product(const Vector3d& a, const Vector3d& b) {
  return {a.dot(b), a[0] * b[1] + b[0] * a[1], a[0] * b[2] + b[0] * a[2]};
}

/// The x with a o x = b; `a` inside the cone.
inline Vector3d jordan_quotient(const Vector3d& a, const Vector3d& b) {
  const double first = (a[0] * b[0] - a[1] * b[1] - a[2] * b[2]) / cone_determinant(a);
  return {first, (b[1] - first * a[1]) / a[0], (b[2] - first * a[2]) / a[0]};
}

/// The largest step <= `limit` for which x + step d is in the cone; x inside it.
inline double step_to_boundary(const Vector3d& x, const Vector3d& d, double limit) {
  // The determinant along d is c + 2 b step + q step^2; its smallest positive root ends the step.
  const double q = cone_determinant(d), c = cone_determinant(x);
  const double b = x[0] * d[0] - x[1] * d[1] - x[2] * d[2], discriminant = b * b - q * c;
  if (d[0] < 0) limit = std::min(limit, -x[0] / d[0]);
  if (discriminant < 0) return limit;
  const double denominator = std::sqrt(discriminant) - b;
  return denominator > 0 ? std::min(limit, c / denominator) : limit;
}

}  // namespace gonogo::sim
