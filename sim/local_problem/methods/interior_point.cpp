// Primal-dual interior point for r in K and z = s^* in the product of Lorentz cones, one per disc:
//
//   W r + q + sum_d c_d |z_d| e_n = A^T z      (the sum for `coulomb` alone)
//   s = A r,  s o z = sigma gap e              s and z inside their cones, gap to 0
//
// Newton's steps are scaled by Nesterov & Todd, predicted and corrected by Mehrotra (1992). De Saxce's term enters
// Newton's matrix, so that Coulomb's law needs no outer iteration (Acary, Armand, Nguyen & Shpakovych 2024). Where the
// solution is degenerate, the error falls only with the root of the gap. Rounding then ends the steps above the
// tolerance, and proximal points finish from there.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sim/local_problem/algebra/newton_system.h"
#include "sim/local_problem/algebra/scaled_problem.h"
#include "sim/local_problem/methods/methods.h"

namespace gonogo::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

// A Lorentz cone { x_0 >= |(x_1, x_2)| } as an interior point method sees it: scaling by Nesterov & Todd (1997), Jordan
// product, step to the boundary. A smaller cone leaves x_2, or x_1 and x_2, at 0.

/// Numbers are near 1, so that squares neither overflow nor vanish before they matter.
double tail_length(const Vector3d& x) { return std::sqrt(x[1] * x[1] + x[2] * x[2]); }

/// x_0^2 - |x_1|^2 as a product, which cancels less; positive inside the cone.
double cone_determinant(const Vector3d& x) { return (x[0] - tail_length(x)) * (x[0] + tail_length(x)); }

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

Vector3d jordan_product(const Vector3d& a, const Vector3d& b) {
  return {a.dot(b), a[0] * b[1] + b[0] * a[1], a[0] * b[2] + b[0] * a[2]};
}

/// The x with a o x = b; `a` inside the cone.
Vector3d jordan_quotient(const Vector3d& a, const Vector3d& b) {
  const double first = (a[0] * b[0] - a[1] * b[1] - a[2] * b[2]) / cone_determinant(a);
  return {first, (b[1] - first * a[1]) / a[0], (b[2] - first * a[2]) / a[0]};
}

/// The largest step <= `limit` for which x + step d is in the cone; x inside it.
double step_to_boundary(const Vector3d& x, const Vector3d& d, double limit) {
  // The determinant along d is c + 2 b step + q step^2; its smallest positive root ends the step.
  const double q = cone_determinant(d), c = cone_determinant(x);
  const double b = x[0] * d[0] - x[1] * d[1] - x[2] * d[2], discriminant = b * b - q * c;
  if (d[0] < 0) limit = std::min(limit, -x[0] / d[0]);
  if (discriminant < 0) return limit;
  const double denominator = std::sqrt(discriminant) - b;
  return denominator > 0 ? std::min(limit, c / denominator) : limit;
}

/// One Lorentz cone: s = (c r_n, r_d) of one disc of a contact; s = r_n for a contact without friction.
struct Cone {
  Index normal = 0, first = 0;  // rows of r_n and r_d
  int size = 0;                 // of r_d
  double c = 1;
  Vector3d s = Vector3d::Zero(), z = Vector3d::UnitX();
  Vector3d ds = Vector3d::Zero(), dz = Vector3d::Zero();
  Vector3d affine = Vector3d::Zero();  // (w^-1 ds) o (w dz) of the predictor
  Matrix3d scaling = Matrix3d::Identity(), inverse = Matrix3d::Identity();

  Vector3d image(const VectorXd& r) const {
    Vector3d x = Vector3d::Zero();
    x[0] = c * r[normal];
    for (int a = 0; a < size; ++a) x[1 + a] = r[first + a];
    return x;
  }
  void add_transposed(const Vector3d& x, VectorXd& r) const {
    r[normal] += c * x[0];
    for (int a = 0; a < size; ++a) r[first + a] += x[1 + a];
  }
  Index row(int a) const { return a == 0 ? normal : first + a - 1; }
  double factor(int a) const { return a == 0 ? c : 1; }
};

struct Cones {
  std::vector<Cone> cones;
  std::vector<char> fixed;  // [row] 1: without friction, always 0

  explicit Cones(const LocalProblem& p) : fixed(p.q.size(), 0) {
    for (Index i = 0; i < p.contact_count(); ++i) {
      const Index normal = i * p.dimension;
      const std::size_t before = cones.size();
      for (int d = 0; d < p.disc_count(); ++d) {
        const FrictionDisc disc = p.disc(d);
        const double c = p.coefficient(i, d);
        if (c > 0)
          cones.push_back({.normal = normal, .first = normal + disc.first, .size = disc.size, .c = c});
        else
          std::fill_n(fixed.begin() + normal + disc.first, disc.size, 1);
      }
      if (cones.size() == before) cones.push_back({.normal = normal, .first = normal});
    }
  }
};

class InteriorPoint {
 public:
  InteriorPoint(const LocalProblem& p, Target target, NewtonKind kind)
      : target_(target), problem_(p), of_(p), cones_(p) {
    is_symmetric_ = is_symmetric(of_.w);
    clear_fixed();
    system_ = make_newton_system(kind, target_ == Target::ccp && is_symmetric_, p, of_, cones_.fixed);
    r_ = VectorXd::Zero(of_.q.size());
    for (const Cone& cone : cones_.cones) r_[cone.normal] = 1;
    for (Cone& cone : cones_.cones) cone.s = cone.image(r_);
    measure();
  }

  const std::vector<double>& impulses() const { return impulses_; }
  const std::vector<double>& velocities() const { return velocities_; }
  LinearWork work() const {
    LinearWork work = system_->work();
    if (work.solves > 0) return work;
    work.solves = solves_;
    work.setup_ms = setup_ms_;
    work.solve_ms = solve_ms_;
    return work;
  }
  bool is_symmetric() const { return is_symmetric_; }

  /// One predictor and corrector (Mehrotra 1992); false when the matrix cannot be factorised.
  bool step() {
    evaluate();
    if (!factorise()) return false;
    const double mu = gap_;
    if (!solve(0, false)) return false;
    const double reach = longest_step(1);
    double after = 0;
    for (Cone& cone : cones_.cones) {
      after += (cone.s + reach * cone.ds).dot(cone.z + reach * cone.dz);
      cone.affine = jordan_product(cone.inverse * cone.ds, cone.scaling * cone.dz);
    }
    const double share = std::max(after, 0.0) / (mu * double(cones_.cones.size()));
    const double sigma = std::clamp(share * share * share, 1e-8, 1.0);
    if (!solve(sigma * mu, true)) return false;
    move(std::min(1.0, 0.995 * longest_step(1.1)));
    return true;
  }

 private:
  void evaluate() {
    gap_ = 0;
    for (const Cone& cone : cones_.cones) gap_ += cone.s.dot(cone.z);
    gap_ /= double(cones_.cones.size());
    defect_ = of_.unit.cwiseProduct(Eigen::Map<const VectorXd>(velocities_.data(), r_.size())) / of_.speed;
    for (Cone& cone : cones_.cones) {
      cone.add_transposed(-cone.z, defect_);
      const NesterovTodd scaling(cone.s, cone.z);
      cone.scaling = scaling.w;
      cone.inverse = scaling.inverse;
      if (target_ == Target::coulomb) defect_[cone.normal] += cone.c * slip(cone);
    }
    for (Eigen::Index k = 0; k < defect_.size(); ++k)
      if (cones_.fixed[k]) defect_[k] = 0;
  }

  /// Files with few digits hold a W symmetric to 1e-3 only, for which Cholesky's steps would be wrong.
  static bool is_symmetric(const Sparse& w) {
    constexpr double kRounding = 1e-12;
    return (w - Sparse(w.transpose())).norm() <= kRounding * w.norm();
  }

  /// |u_d|, which is |z_d| at the solution, rounded at 0 by a width that shrinks with the gap.
  double slip(const Cone& cone) const {
    return cone.size > 0 ? std::hypot(tail_length(cone.z), std::min(gap_, 1.0)) : 0;
  }

  /// (W + B w^-2 A) dr = rhs with s = A r. B is the transpose of A, less the slip's derivative in the rows of the
  /// normals, so that the pattern is that of W and its diagonal blocks.
  bool factorise() {
    if (cone_matrix_.rows() == 0) make_cone_matrix();
    double* const value = cone_matrix_.valuePtr();
    std::fill_n(value, cone_matrix_.nonZeros(), 0.0);
    auto slot = slot_.begin();
    for (const Cone& cone : cones_.cones) {
      const Matrix3d square = cone.inverse * cone.inverse;
      for (int a = 0; a <= cone.size; ++a)
        for (int b = 0; b <= cone.size; ++b) value[*slot++] += cone.factor(a) * square(a, b) * cone.factor(b);
      if (target_ == Target::ccp) continue;
      const Eigen::RowVector3d slip = cone.c * slip_direction(cone).transpose() * square;
      for (int b = 0; b <= cone.size; ++b) value[*slot++] -= slip[b] * cone.factor(b);
    }
    for (; slot != slot_.end(); ++slot) value[*slot] = 1;  // rows that stay 0
    const std::clock_t start = std::clock();
    const bool is_sound = system_->factorise(of_.w, cone_matrix_);
    setup_ms_ += ms_since(start);
    return is_sound;
  }

  /// The pattern of the cones' blocks, and the places of factorise()'s entries among its values.
  void make_cone_matrix() {
    std::vector<Eigen::Triplet<double>> entry;
    for (const Cone& cone : cones_.cones) {
      for (int a = 0; a <= cone.size; ++a)
        for (int b = 0; b <= cone.size; ++b) entry.emplace_back(cone.row(a), cone.row(b), 0);
      if (target_ == Target::ccp) continue;
      for (int b = 0; b <= cone.size; ++b) entry.emplace_back(cone.normal, cone.row(b), 0);
    }
    for (Eigen::Index k = 0; k < r_.size(); ++k)
      if (cones_.fixed[std::size_t(k)]) entry.emplace_back(k, k, 0);
    cone_matrix_ = Sparse(r_.size(), r_.size());
    cone_matrix_.setFromTriplets(entry.begin(), entry.end());
    const int* const inner = cone_matrix_.innerIndexPtr();
    for (const auto& e : entry) {
      const int* const begin = inner + cone_matrix_.outerIndexPtr()[e.col()];
      slot_.push_back(std::lower_bound(begin, inner + cone_matrix_.outerIndexPtr()[e.col() + 1], e.row()) - inner);
    }
  }

  /// Rows that stay 0 take no part in products with W.
  void clear_fixed() {
    of_.w.prune([&](Eigen::Index row, Eigen::Index column, double) {
      return !cones_.fixed[std::size_t(row)] && !cones_.fixed[std::size_t(column)];
    });
  }

  /// Derivative of slip() by z.
  Vector3d slip_direction(const Cone& cone) const {
    return cone.size > 0 ? Vector3d(Vector3d(0, cone.z[1], cone.z[2]) / slip(cone)) : Vector3d::Zero();
  }

  bool solve(double centre, bool corrected) {
    VectorXd rhs = -defect_;
    std::vector<Vector3d> drive;
    drive.reserve(cones_.cones.size());
    for (const Cone& cone : cones_.cones) {
      const Vector3d lambda = cone.scaling * cone.z;
      Vector3d target = -jordan_product(lambda, lambda);
      target[0] += centre;
      if (corrected) target -= cone.affine;
      drive.push_back(cone.inverse * jordan_quotient(lambda, target));
      cone.add_transposed(drive.back(), rhs);
      if (target_ == Target::coulomb) rhs[cone.normal] -= cone.c * slip_direction(cone).dot(drive.back());
    }
    for (Eigen::Index k = 0; k < rhs.size(); ++k)
      if (cones_.fixed[k]) rhs[k] = 0;
    const std::clock_t start = std::clock();
    const bool is_solved = system_->solve(rhs, dr_);
    solve_ms_ += ms_since(start);
    ++solves_;
    if (!is_solved) return false;
    for (std::size_t k = 0; k < cones_.cones.size(); ++k) {
      Cone& cone = cones_.cones[k];
      cone.ds = cone.image(dr_);
      cone.dz = drive[k] - cone.inverse * (cone.inverse * cone.ds);
    }
    return true;
  }

  double longest_step(double limit) const {
    for (const Cone& cone : cones_.cones) {
      limit = step_to_boundary(cone.s, cone.ds, limit);
      limit = step_to_boundary(cone.z, cone.dz, limit);
    }
    return limit;
  }

  void move(double step) {
    r_ += step * dr_;
    for (Cone& cone : cones_.cones) {
      cone.s = cone.image(r_);
      cone.z += step * cone.dz;
    }
    measure();
  }

  /// Impulses, and u = W r + q, in the units of the problem.
  void measure() {
    impulses_ = of_.impulses(r_);
    velocities_ = velocity(problem_, impulses_);
  }

  Target target_;
  const LocalProblem& problem_;
  ScaledProblem of_;
  Cones cones_;
  std::unique_ptr<NewtonSystem> system_;
  Sparse cone_matrix_;
  std::vector<std::ptrdiff_t> slot_;
  VectorXd r_, dr_, defect_;
  std::vector<double> impulses_, velocities_;
  bool is_symmetric_ = false;
  double gap_ = 1;  // mean of s.z over the cones
  long solves_ = 0;
  double setup_ms_ = 0, solve_ms_ = 0;
};

}  // namespace

LocalSolution solve_pdip(const LocalProblem& problem, const LocalSolveSettings& settings, NewtonKind kind) {
  constexpr int kPatience = 10;  // steps without a lower error: rounding has the last word
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 4000;
  BestSoFar best(problem, settings);
  InteriorPoint method(problem, settings.target, kind);
  const bool by_gradients = kind == NewtonKind::blocks || kind == NewtonKind::tensor_train;
  if (by_gradients && !method.is_symmetric()) {
    best.best.refusal =
        std::string(solver_name(settings.solver)) + " refuses a matrix W that is not symmetric; take pdip";
    return best.best;
  }
  int k = 0, latest_gain = 0;
  while (k < max && best.best.error > settings.tolerance && k - latest_gain < kPatience && method.step()) {
    const double before = best.best.error;
    ++k;
    if (best.offer(method.impulses(), method.velocities(), k); best.best.error < before) latest_gain = k;
  }
  best.best.iterations = k;
  best.best.linear = method.work();
  // The others show what Krylov methods reach alone.
  const bool is_direct = kind == NewtonKind::direct || kind == NewtonKind::bodies;
  if (is_direct && problem.is_whole && k < max && best.best.error > settings.tolerance)
    finish_by_proximal_points(problem, settings, max - k, best);
  return best.best;
}

}  // namespace gonogo::sim
