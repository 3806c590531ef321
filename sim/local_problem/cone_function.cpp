#include "sim/local_problem/cone_function.h"

#include <algorithm>
#include <cmath>

namespace gonogo::sim {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// One disc's part of v; 0 behind it in the plane.
Vector2d part(const double* v, const FrictionDisc& disc) {
  return {v[disc.first], disc.size > 1 ? v[disc.first + 1] : 0};
}

/// The disc's y clipped to its bound: direction, and the derivative of the clipped y for a fixed bound.
struct Clipped {
  Vector2d value, direction = Vector2d::Zero();
  Matrix2d turning = Matrix2d::Identity();

  Clipped(const Vector2d& y, double bound) : value(y) {
    const double length = y.norm();
    if (length <= bound) return;
    direction = y / length;
    value = bound * direction;
    turning = bound / length * (Matrix2d::Identity() - direction * direction.transpose());
  }
};

bool alart_curnier(const LocalProblem& problem, Index contact, const double* weight, const double* r, const double* u,
                   double* f, ConeDerivative* derivative) {
  const double y_n = r[0] - u[0] / weight[0], normal = std::max(0.0, y_n);
  f[0] = r[0] - normal;
  if (derivative) derivative->by_u(0, 0) = 1 / weight[0];
  for (int k = 0; k < problem.disc_count(); ++k) {
    const FrictionDisc disc = problem.disc(k);
    const double c = problem.coefficient(contact, k), w = weight[disc.first];
    const Clipped y(part(r, disc) - part(u, disc) / w, c * normal);
    for (int a = 0; a < disc.size; ++a) f[disc.first + a] = r[disc.first + a] - y.value[a];
    for (int a = 0; a < disc.size && derivative; ++a) {
      const int row = disc.first + a;
      for (int b = 0; b < disc.size; ++b) {
        derivative->by_u(row, disc.first + b) = y.turning(a, b) / w;
        derivative->by_r(row, disc.first + b) = (a == b) - y.turning(a, b);
      }
      derivative->by_r(row, 0) = -c * y.direction[a];  // the bound c y_n moves with r_n and u_n
      derivative->by_u(row, 0) = c * y.direction[a] / weight[0];
    }
  }
  return y_n <= 0;
}

/// Derivative of the projection where the normal impulse n > 0: n is the mean over the clipped discs of
/// project_onto_cone.
ContactMatrix projection_derivative(const LocalProblem& problem, Index contact, const double* y, double n) {
  const int d = problem.dimension;
  ContactMatrix p = ContactMatrix::Identity(d, d);
  double mass = 1;
  for (int k = 0; k < problem.disc_count(); ++k) {
    const double c = problem.coefficient(contact, k);
    const Clipped clipped(part(y, problem.disc(k)), c * n);
    for (int a = 0; a < problem.disc(k).size; ++a) p(0, problem.disc(k).first + a) = c * clipped.direction[a];
    mass += c * c * clipped.direction.squaredNorm();
  }
  p.row(0) /= mass;
  for (int k = 0; k < problem.disc_count(); ++k) {
    const FrictionDisc disc = problem.disc(k);
    const double c = problem.coefficient(contact, k);
    const Clipped clipped(part(y, disc), c * n);
    for (int a = 0; a < disc.size; ++a) {
      p.row(disc.first + a) = c * clipped.direction[a] * p.row(0);
      for (int b = 0; b < disc.size; ++b) p(disc.first + a, disc.first + b) += clipped.turning(a, b);
    }
  }
  return p;
}

bool natural_map(const LocalProblem& problem, Index contact, const double* weight, const double* r, const double* u,
                 double* f, ConeDerivative* derivative) {
  const int d = problem.dimension;
  double y[5], nearest[5];
  for (int a = 0; a < d; ++a) nearest[a] = y[a] = r[a] - u[a] / weight[0];
  project_onto_cone(problem, contact, nearest);
  for (int a = 0; a < d; ++a) f[a] = r[a] - nearest[a];
  if (derivative && nearest[0] > 0) {
    const ContactMatrix p = projection_derivative(problem, contact, y, nearest[0]);
    derivative->by_u = p / weight[0];
    derivative->by_r = ContactMatrix::Identity(d, d) - p;
  }
  return nearest[0] <= 0;
}

}  // namespace

bool cone_function(const LocalProblem& problem, Index contact, Target target, const double* weight, const double* r,
                   const double* u, double* f, ConeDerivative* derivative) {
  if (derivative) {
    derivative->by_u = ContactMatrix::Zero(problem.dimension, problem.dimension);
    derivative->by_r = ContactMatrix::Zero(problem.dimension, problem.dimension);
  }
  return target == Target::coulomb ? alart_curnier(problem, contact, weight, r, u, f, derivative)
                                   : natural_map(problem, contact, weight, r, u, f, derivative);
}

}  // namespace gonogo::sim
