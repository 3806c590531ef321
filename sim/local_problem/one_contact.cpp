#include "sim/local_problem/one_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 4, 4>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 4, 1>;
using RowMajorBlock = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>;

/// Root of f between low, where f > 0, and high, where f <= 0: regula falsi with the correction of Anderson & Bjorck
/// (1973), and bisection when it is slow. Returns the end of the bracket with f <= 0, when f is within `rounding` of 0
/// or the bracket within rounding of a point.
template <class F>
double root(const F& f, double low, double at_low, double high, double at_high, double rounding) {
  for (int k = 0; k < 120 && at_high < -rounding && high - low > 4e-16 * high; ++k) {
    double x = high - at_high * (high - low) / (at_high - at_low);
    if (k % 4 == 3 || !(x > low && x < high)) x = low + (high - low) / 2;
    if (!(x > low && x < high)) break;
    const double at_x = f(x);
    const double shrink = 1 - at_x / (at_x > 0 ? at_low : at_high), factor = shrink > 0 ? shrink : 0.5;
    if (at_x > 0) {
      low = x;
      at_low = at_x;
      at_high *= factor;
    } else {
      high = x;
      at_high = at_x;
      at_low *= factor;
    }
  }
  return high;
}

/// The same with high to be found, at `guess` or beyond; f(0) > 0 is given.
template <class F>
double root_above_zero(const F& f, double at_zero, double guess, double rounding) {
  double low = 0, at_low = at_zero, high = guess, at_high = f(high);
  for (int k = 0; k < 300 && at_high > 0; ++k) {
    low = high;
    at_low = at_high;
    high *= 8;
    at_high = f(high);
  }
  return root(f, low, at_low, high, at_high, rounding);
}

/// Friction with r_f = -(s + diag(lambda))^-1 g and the bounds c_d r_n, r_n = n - tilt . r_f.
struct Friction {
  const LocalProblem& problem;
  Index contact;
  double n, rounding;
  Vector tilt, g;
  Matrix s;

  double coefficient(int d) const { return problem.coefficient(contact, d); }
  double normal(const Vector& r_f) const { return n - tilt.dot(r_f); }

  /// lambda per disc; infinite: no impulse on that disc.
  Vector impulse(const double* lambda) const {
    Matrix m = s;
    Vector rhs = -g;
    for (int d = 0; d < problem.disc_count(); ++d)
      for (int k = 0; k < problem.disc(d).size; ++k) {
        const int row = problem.disc(d).first - 1 + k;
        m(row, row) += std::isfinite(lambda[d]) ? lambda[d] : 0;
        if (std::isfinite(lambda[d])) continue;
        m.row(row).setZero();
        m(row, row) = 1;
        rhs[row] = 0;
      }
    return solve(m, rhs);
  }

  static Vector solve(const Matrix& m, const Vector& rhs) {
    if (m.rows() == 1 && m(0, 0) != 0) return rhs / m(0, 0);
    if (m.rows() == 2) {
      const double det = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
      Vector x(2);
      x << m(1, 1) * rhs[0] - m(0, 1) * rhs[1], m(0, 0) * rhs[1] - m(1, 0) * rhs[0];
      if (det != 0) return x / det;
    }
    return m.fullPivLu().solve(rhs);
  }

  /// Excess of disc d over its bound at lambda[d] = x, with the discs after it solved.
  double excess(int d, double x, double* lambda) const {
    lambda[d] = x;
    if (d + 1 < problem.disc_count()) solve_disc(d + 1, lambda);
    const Vector r_f = impulse(lambda);
    double square = 0;
    for (int k = 0; k < problem.disc(d).size; ++k) {
      const double part = r_f[problem.disc(d).first - 1 + k];
      square += part * part;
    }
    return std::sqrt(square) - coefficient(d) * normal(r_f);
  }

  /// lambda[d] = 0 inside the bound, or the root of the excess; infinite without friction.
  void solve_disc(int d, double* lambda) const {
    const auto excess_of = [&](double x) { return excess(d, x, lambda); };
    if (coefficient(d) == 0) {
      excess_of(std::numeric_limits<double>::infinity());
    } else if (const double at_zero = excess_of(0); at_zero > 0) {
      excess_of(root_above_zero(excess_of, at_zero, 2 * s.trace() + std::numeric_limits<double>::min(), rounding));
    }
  }

  Vector solution() const {
    double lambda[2] = {0, 0};
    solve_disc(0, lambda);
    return impulse(lambda);
  }
};

void set(double* r, double normal, const Vector& r_f) {
  r[0] = std::max(0.0, normal);
  for (int i = 0; i < r_f.size(); ++i) r[i + 1] = r_f[i];
}

/// b_n < 0; one disc.
void slide_or_stick(const LocalProblem& problem, Index contact, const double* a, const double* b, double* r) {
  const int f = problem.dimension - 1;
  const RowMajorBlock block(a, f + 1, f + 1);
  Friction friction{.problem = problem,
                    .contact = contact,
                    .n = -b[0] / a[0],
                    .rounding = 1e-16 * std::abs(b[0] / a[0]),
                    .tilt = Vector(f),
                    .g = Vector(f),
                    .s = Matrix(f, f)};
  for (int i = 0; i < f; ++i) {
    friction.tilt[i] = block(0, i + 1) / a[0];
    friction.g[i] = b[i + 1] - block(i + 1, 0) * b[0] / a[0];
    for (int j = 0; j < f; ++j) friction.s(i, j) = block(i + 1, j + 1) - block(i + 1, 0) * block(0, j + 1) / a[0];
  }
  const Vector r_f = friction.solution();
  set(r, friction.normal(r_f), r_f);
}

/// b_n < 0; any number of discs.
void root_over_normal(const LocalProblem& problem, Index contact, const double* a, const double* b, double* r) {
  const int f = problem.dimension - 1;
  const RowMajorBlock block(a, f + 1, f + 1);
  Friction friction{.problem = problem,
                    .contact = contact,
                    .n = 0,
                    .rounding = 0,
                    .tilt = Vector::Zero(f),
                    .g = Vector(f),
                    .s = block.bottomRightCorner(f, f)};
  const auto approach = [&](double n) {  // -u_n; leaves the solution for this n in r
    friction.n = n;
    friction.rounding = 1e-16 * n;
    for (int i = 0; i < f; ++i) friction.g[i] = b[i + 1] + block(i + 1, 0) * n;
    const Vector r_f = friction.solution();
    set(r, n, r_f);
    double u_n = b[0] + a[0] * n;
    for (int i = 0; i < f; ++i) u_n += a[i + 1] * r_f[i];
    return -u_n;
  };
  approach(root_above_zero(approach, -b[0], -b[0] / a[0], 1e-16 * std::abs(b[0])));
}

/// Newton on the cone function from the r given; whether it converged.
bool newton(const LocalProblem& problem, Index contact, Target target, const double* a, const double* b, double* r) {
  constexpr int kMaxSteps = 15;
  const int d = problem.dimension;
  const RowMajorBlock block(a, d, d);
  const Eigen::Map<const Eigen::VectorXd> at_rest(b, d);
  const double largest = block.diagonal().maxCoeff();
  const double weight[5] = {largest, largest, largest, largest, largest};
  Eigen::Map<Eigen::VectorXd> impulse(r, d);
  double f[5];
  ConeDerivative derivative;
  for (int k = 0; k < kMaxSteps; ++k) {
    const ContactVector u = block * impulse + at_rest;
    const bool opens = cone_function(problem, contact, target, weight, r, u.data(), f, &derivative);
    const Eigen::Map<const Eigen::VectorXd> rest(f, d);
    if (rest.norm() <= 1e-15 * (at_rest.norm() / largest + impulse.norm())) return true;
    const ContactMatrix jacobian = derivative.by_u * block + derivative.by_r;
    const Eigen::VectorXd step = opens ? Eigen::VectorXd(rest) : jacobian.partialPivLu().solve(rest);
    if (!step.allFinite()) return false;
    impulse -= step;
  }
  return false;
}

void solve_coulomb(const LocalProblem& problem, Index contact, const double* a, const double* b, double* r) {
  if (b[0] >= 0) {
    std::fill(r, r + problem.dimension, 0.0);
  } else if (problem.disc_count() == 1) {
    slide_or_stick(problem, contact, a, b, r);
  } else if (!newton(problem, contact, Target::coulomb, a, b, r)) {
    root_over_normal(problem, contact, a, b, r);
  }
}

/// Projected gradients, which cannot fail on this convex program, until Newton converges from where they lead.
void solve_ccp(const LocalProblem& problem, Index contact, const double* a, const double* b, double* r) {
  constexpr int kRounds = 50, kSteps = 100;
  const int d = problem.dimension;
  double trace = 0, guess[5], u[5];
  for (int i = 0; i < d; ++i) trace += a[i * (d + 1)];
  std::copy(r, r + d, guess);
  for (int round = 0; round < kRounds; ++round) {
    if (newton(problem, contact, Target::ccp, a, b, r)) return;
    std::copy(guess, guess + d, r);
    for (int k = 0; k < kSteps; ++k) {
      for (int i = 0; i < d; ++i) {
        u[i] = b[i];
        for (int j = 0; j < d; ++j) u[i] += a[i * d + j] * r[j];
      }
      for (int i = 0; i < d; ++i) r[i] -= u[i] / trace;
      project_onto_cone(problem, contact, r);
    }
    std::copy(r, r + d, guess);
  }
}

}  // namespace

void solve_one_contact(const LocalProblem& problem, Index contact, Target target, const double* a, const double* b,
                       double* r) {
  target == Target::coulomb ? solve_coulomb(problem, contact, a, b, r) : solve_ccp(problem, contact, a, b, r);
}

}  // namespace gonogo::sim
