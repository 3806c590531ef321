#include "vehicle/feasible/cone_program.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonogo::vehicle {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// u o v: products of half-lines, (u.v, u0 v1 + v0 u1) of cones.
Vector product(const std::vector<int>& cone, const Vector& u, const Vector& v) {
  Vector w(u.size());
  int at = 0;
  for (const int n : cone) {
    w(at) = u.segment(at, n).dot(v.segment(at, n));
    if (n > 1) w.segment(at + 1, n - 1) = u(at) * v.segment(at + 1, n - 1) + v(at) * u.segment(at + 1, n - 1);
    at += n;
  }
  return w;
}

/// x with l o x = r.
Vector quotient(const std::vector<int>& cone, const Vector& l, const Vector& r) {
  Vector x(l.size());
  int at = 0;
  for (const int n : cone) {
    const auto tail = l.segment(at + 1, n - 1);
    const double length = tail.norm(), determinant = (l(at) - length) * (l(at) + length);
    x(at) = (l(at) * r(at) - tail.dot(r.segment(at + 1, n - 1))) / determinant;
    x.segment(at + 1, n - 1) = (r.segment(at + 1, n - 1) - x(at) * tail) / l(at);
    at += n;
  }
  return x;
}

Vector identity(const std::vector<int>& cone, Eigen::Index size) {
  Vector e = Vector::Zero(size);
  int at = 0;
  for (const int n : cone) {
    e(at) = 1;
    at += n;
  }
  return e;
}

/// Largest step a along d at which s + a d is still in the cones.
double longest_step(const std::vector<int>& cone, const Vector& s, const Vector& d) {
  double longest = std::numeric_limits<double>::infinity();
  int at = 0;
  for (const int n : cone) {
    // (s0 + a d0)^2 = |s1 + a d1|^2, first positive root, and s0 + a d0 = 0.
    const auto s1 = s.segment(at + 1, n - 1), d1 = d.segment(at + 1, n - 1);
    const double p = d(at) * d(at) - d1.squaredNorm(), q = s(at) * d(at) - s1.dot(d1), length = s1.norm(),
                 r = std::max((s(at) - length) * (s(at) + length), 0.0);
    if (d(at) < 0) longest = std::min(longest, -s(at) / d(at));
    const double root = q * q - p * r;
    if (n > 1 && root >= 0) {
      const double denominator = -q + std::sqrt(root);  // r / denominator is the smaller positive root
      if (denominator > 0) longest = std::min(longest, r / denominator);
    }
    at += n;
  }
  return longest;
}

/// W with W z = W^-1 s = l: the geometric mean between s and z.
struct Scaling {
  Matrix w, inverse;
  Vector l;

  Scaling(const std::vector<int>& cone, const Vector& s, const Vector& z)
      : w(Matrix::Zero(s.size(), s.size())), inverse(Matrix::Zero(s.size(), s.size())) {
    int at = 0;
    for (const int n : cone) {
      add(at, n, s.segment(at, n), z.segment(at, n));
      at += n;
    }
    l = w * z;
  }

 private:
  /// Written as a product, which cancels less near the boundary.
  static double size(const Vector& u) {
    const double tail = u.tail(u.size() - 1).norm();
    return std::sqrt((u(0) - tail) * (u(0) + tail));
  }

  void add(int at, int n, const Vector& s, const Vector& z) {
    const double of_s = size(s), of_z = size(z), scale = std::sqrt(of_s / of_z);
    Vector mirrored = z / of_z;
    mirrored.tail(n - 1) *= -1;
    const Vector unit = s / of_s;
    Vector mean = unit + mirrored;
    mean /= size(mean);
    const Matrix block = hyperbolic(mean);
    w.block(at, at, n, n) = scale * block;
    mean.tail(n - 1) *= -1;
    inverse.block(at, at, n, n) = hyperbolic(mean) / scale;
  }

  /// Symmetric square root of 2 u u^T - J for u0^2 - |u1|^2 = 1.
  static Matrix hyperbolic(const Vector& u) {
    const Eigen::Index n = u.size();
    Matrix m(n, n);
    const Vector tail = u.tail(n - 1);
    m(0, 0) = u(0);
    m.block(0, 1, 1, n - 1) = tail.transpose();
    m.block(1, 0, n - 1, 1) = tail;
    m.block(1, 1, n - 1, n - 1) = Matrix::Identity(n - 1, n - 1) + tail * tail.transpose() / (1 + u(0));
    return m;
  }
};

struct Iterate {
  Vector x, y, s, z;
};

struct Residuals {
  Vector dual, equation, cone;
  double largest() const {
    const auto norm = [](const Vector& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; };
    return std::max({norm(dual), norm(equation), norm(cone)});
  }
};

Residuals residuals(const ConeProgram& p, const Iterate& i) {
  return {p.c + p.A.transpose() * i.y + p.G.transpose() * i.z, p.A * i.x - p.b, p.G * i.x + i.s - p.h};
}

constexpr double kRegularisation = 1e-9;

/// Newton's equations of the central path, factored once a step.
class Newton {
 public:
  Newton(const ConeProgram& p, const Scaling& w) : p_(p), w_(w) {
    const Eigen::Index n = p.c.size(), m = p.A.rows(), k = p.G.rows();
    matrix_ = Matrix::Zero(n + m + k, n + m + k);
    matrix_.block(0, n, n, m) = p.A.transpose();
    matrix_.block(0, n + m, n, k) = p.G.transpose();
    matrix_.block(n, 0, m, n) = p.A;
    matrix_.block(n + m, 0, k, n) = p.G;
    matrix_.block(n + m, n + m, k, k) = -w.w * w.w;
    // Directions that no cone sees (tangential forces without friction limits) would make it singular.
    Matrix regular = matrix_;
    regular.diagonal().head(n).array() += kRegularisation;
    factor_.compute(regular);
  }

  /// Direction that takes the residuals away and makes l o (W dz + W^-1 ds) = -target.
  Iterate direction(const Residuals& r, const Vector& target) const {
    const Eigen::Index n = p_.c.size(), m = p_.A.rows(), k = p_.G.rows();
    const Vector wanted = w_.w * quotient(p_.cone, w_.l, -target);
    Vector right(n + m + k);
    right << -r.dual, -r.equation, -r.cone - wanted;
    Vector u = factor_.solve(right);
    for (int refined = 0; refined < 3; ++refined) u += factor_.solve(right - matrix_ * u);
    Iterate d{u.head(n), u.segment(n, m), {}, u.tail(k)};
    d.s = wanted - w_.w * (w_.w * d.z);
    return d;
  }

 private:
  const ConeProgram& p_;
  const Scaling& w_;
  Matrix matrix_;
  Eigen::PartialPivLU<Matrix> factor_;
};

double step_length(const ConeProgram& p, const Iterate& at, const Iterate& d, double share) {
  return std::min(1.0, share * std::min(longest_step(p.cone, at.s, d.s), longest_step(p.cone, at.z, d.z)));
}

void advance(Iterate& i, const Iterate& d, double a) {
  i.x += a * d.x;
  i.y += a * d.y;
  i.s += a * d.s;
  i.z += a * d.z;
}

/// The program with the equations that say something new; false when they contradict each other.
bool independent_equations(ConeProgram& p) {
  if (p.A.rows() == 0) return true;
  const Eigen::ColPivHouseholderQR<Matrix> qr(p.A.transpose());
  const Eigen::Index rank = qr.rank();
  const Vector any = p.A.completeOrthogonalDecomposition().solve(p.b);
  if ((p.A * any - p.b).cwiseAbs().maxCoeff() > 1e-9 * (1 + p.b.cwiseAbs().maxCoeff())) return false;
  Matrix kept(rank, p.A.cols());
  Vector right(rank);
  for (Eigen::Index i = 0; i < rank; ++i) {
    kept.row(i) = p.A.row(qr.colsPermutation().indices()(i));
    right(i) = p.b(qr.colsPermutation().indices()(i));
  }
  p.A = kept;
  p.b = right;
  return true;
}

}  // namespace

ConeAnswer solve(ConeProgram p, double tolerance) {
  constexpr int kMaxIterations = 100;
  ConeAnswer answer;
  answer.consistent = independent_equations(p);
  if (!answer.consistent) return answer;
  const double degree = double(p.cone.size());
  const Vector e = identity(p.cone, p.h.size());
  Iterate i{Vector::Zero(p.c.size()), Vector::Zero(p.b.size()), e, e};
  for (;; ++answer.iterations) {
    const Residuals r = residuals(p, i);
    const double gap = i.s.dot(i.z);
    answer = {
        .x = i.x, .s = i.s, .y = i.y, .z = i.z, .residual = r.largest(), .gap = gap, .iterations = answer.iterations};
    const double size = 1 + std::max(i.x.cwiseAbs().maxCoeff(), i.z.cwiseAbs().maxCoeff());
    answer.solved = answer.residual < tolerance * size && gap < tolerance * (1 + std::fabs(p.c.dot(i.x)));
    if (answer.solved || answer.iterations >= kMaxIterations) return answer;
    const Scaling w(p.cone, i.s, i.z);
    const Newton newton(p, w);
    const Vector square = product(p.cone, w.l, w.l);
    const Iterate affine = newton.direction(r, square);
    const double reach = step_length(p, i, affine, 1), centring = std::pow(1 - reach, 3);
    const Vector corrected =
        square + product(p.cone, w.inverse * affine.s, w.w * affine.z) - centring * gap / degree * e;
    const Residuals shrunk{(1 - centring) * r.dual, (1 - centring) * r.equation, (1 - centring) * r.cone};
    const Iterate d = newton.direction(shrunk, corrected);
    advance(i, d, step_length(p, i, d, 0.99));
  }
}

}  // namespace gonogo::vehicle
