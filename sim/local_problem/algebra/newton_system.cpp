#include "sim/local_problem/algebra/newton_system.h"

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <algorithm>
#include <vector>

#include "sim/local_problem/algebra/block_ldlt.h"
#include "sim/local_problem/algebra/tensor_train.h"
#include "sim/local_problem/banded/spike_preconditioner.h"

namespace gonogo::sim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

// Over bodies in place of contacts. With W = B B^T (BodyForm) and the cones' C,
//
//   (B B^T + C)^-1 = C^-1 - C^-1 B (I + B^T C^-1 B)^-1 B^T C^-1                      (Woodbury)
//
// The matrix to factorise has six rows per body. Packed spheres have about two contacts with three rows each per body,
// and a body with many contacts, which fills all of W, is one block here.

/// L D L^T by fronts of bodies' blocks, with the interface of Eigen's factors.
class Fronts {
 public:
  void compute(const Sparse& a) {
    Sparse nothing(a.rows(), a.cols());
    is_sound_ = factors_.factorise(a, nothing);
  }
  Eigen::ComputationInfo info() const { return is_sound_ ? Eigen::Success : Eigen::NumericalIssue; }
  VectorXd solve(VectorXd x) const {
    factors_.solve(x);
    return x;
  }

 private:
  BlockLdlt factors_{BodyForm::kFreedoms};
  bool is_sound_ = false;
};

template <class Factors>
class ByBodies final : public NewtonSystem {
 public:
  ByBodies(const Sparse& b, int dimension)
      : b_(b),
        transposed_(b_.transpose()),
        identity_(b_.cols(), b_.cols()),
        unit_(b_.rows(), b_.rows()),
        dimension_(dimension) {
    identity_.setIdentity();
    unit_.setIdentity();
  }

  bool factorise(const Sparse&, const Sparse& cones) override {
    cones_ = cones;
    inverse_ = inverse_blocks(Sparse(cones + kShift * unit_), dimension_);
    const Sparse scaled = inverse_ * b_;
    factors_.compute(Sparse(identity_ + Sparse(transposed_ * scaled)));
    return factors_.info() == Eigen::Success;
  }

  /// The difference of two large terms where C is large; refined against the matrix itself.
  bool solve(const VectorXd& rhs, VectorXd& x) override {
    constexpr int kRefinements = 3;
    constexpr double kEnough = 1e-13;
    const auto by_factors = [this](const VectorXd& right) { return once(right); };
    return solve_refined(b_, transposed_, cones_, rhs, kRefinements, kEnough, by_factors, x);
  }

 private:
  VectorXd once(const VectorXd& rhs) const {
    const VectorXd y = inverse_ * rhs;
    const VectorXd motion = factors_.solve(VectorXd(transposed_ * y));
    return y - inverse_ * VectorXd(b_ * motion);
  }

  /// Added to the cones, whose smallest numbers would else lose all digits. What that changes is refined away.
  static constexpr double kShift = 1e-9;
  Sparse b_, transposed_, identity_, unit_, cones_, inverse_;
  int dimension_;
  Factors factors_;
};

std::unique_ptr<NewtonSystem> make_system_by_bodies(const LocalProblem& problem, const ScaledProblem& of,
                                                    const std::vector<char>& fixed, bool is_symmetric) {
  const Sparse b = scaled_form(problem, of, fixed);
  if (is_symmetric) return std::make_unique<ByBodies<Fronts>>(b, problem.dimension);
  return std::make_unique<ByBodies<Eigen::SparseLU<Sparse>>>(b, problem.dimension);
}

// Over contacts, with bodies of many contacts, the hubs, set apart. With the columns U of W = B B^T that belong to
// them,
//
//   W + C = A + U U^T,   (A + U U^T)^-1 = A^-1 - A^-1 U (I + U^T A^-1 U)^-1 U^T A^-1        (Woodbury)
//
// A hub fills W, since each of its contacts touches all others through it, but gives U six columns at most. So W itself
// is never needed.

/// Contacts of a hub: from here on its clique in W costs more than six columns of U.
constexpr Index kHub = 48;

std::vector<char> hubs_of(const LocalProblem& p) {
  std::vector<Index> contacts(std::size_t(p.bodies->body_count), 0);
  for (const BodyForm::Contact& c : p.bodies->contact)
    for (const Index body : c.body)
      if (body >= 0) ++contacts[std::size_t(body)];
  std::vector<char> is_hub;
  for (const Index count : contacts) is_hub.push_back(count >= kHub);
  return is_hub;
}

/// Columns of b, of hubs or of the other bodies, that hold anything.
Sparse columns_of(const Sparse& b, const std::vector<char>& is_hub, bool of_hubs) {
  std::vector<Eigen::Triplet<double>> entry;
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < b.cols(); ++k) {
    if (bool(is_hub[std::size_t(k / BodyForm::kFreedoms)]) != of_hubs) continue;
    const std::size_t before = entry.size();
    for (Sparse::InnerIterator it(b, k); it; ++it) entry.emplace_back(it.row(), count, it.value());
    if (entry.size() > before) ++count;
  }
  Sparse out(b.rows(), count);
  out.setFromTriplets(entry.begin(), entry.end());
  return out;
}

class WithoutHubs final : public NewtonSystem {
 public:
  WithoutHubs(const Sparse& b, const std::vector<char>& is_hub, int dimension)
      : b_(b), transposed_(b.transpose()), hub_(columns_of(b, is_hub, true)), factors_(dimension) {
    const Sparse others = columns_of(b, is_hub, false);
    w_ = others * Sparse(others.transpose());
  }

  bool factorise(const Sparse&, const Sparse& cones) override {
    cones_ = cones;
    if (!factors_.factorise(w_, cones)) return false;
    image_ = MatrixXd(hub_);
    for (Eigen::Index k = 0; k < image_.cols(); ++k) {
      VectorXd x = image_.col(k);
      factors_.solve(x);
      image_.col(k) = x;
    }
    small_.compute(MatrixXd::Identity(image_.cols(), image_.cols()) + hub_.transpose() * image_);
    return small_.info() == Eigen::Success;
  }

  /// Refined once where the first solution is not exact enough.
  bool solve(const VectorXd& rhs, VectorXd& x) override {
    constexpr int kRefinements = 2;
    constexpr double kEnough = 1e-12;
    const auto by_factors = [this](const VectorXd& right) { return once(right); };
    return solve_refined(b_, transposed_, cones_, rhs, kRefinements, kEnough, by_factors, x);
  }
  LinearWork work() const override { return {.bytes = factors_.bytes(), .multiply_adds = factors_.multiply_adds()}; }

 private:
  VectorXd once(const VectorXd& rhs) const {
    VectorXd x = rhs;
    factors_.solve(x);
    return x - image_ * small_.solve(VectorXd(hub_.transpose() * x));
  }

  Sparse b_, transposed_, hub_, w_, cones_;
  BlockLdlt factors_;
  MatrixXd image_;  // A^-1 U
  Eigen::LDLT<MatrixXd> small_;
};

/// False where bodies are not known.
bool has_hubs(const LocalProblem& problem) {
  if (!problem.bodies) return false;
  const std::vector<char> is_hub = hubs_of(problem);
  return std::count(is_hub.begin(), is_hub.end(), 1) > 0;
}

// By conjugate gradients. The matrix A = W + C is scaled so that the blocks of the contacts on its diagonal are 1. An
// inverse of that as a tensor train preconditions it, after Corona, Gorsich, Jayakumar & Veerapaneni (2019): one
// inverse serves as long as conjugate gradients stay few, and the next one starts from it. An inverse that the rank
// limit spoils is not used.

class BlockSystem final : public NewtonSystem {
 public:
  BlockSystem(int dimension, bool by_tensor_train) : dimension_(dimension), by_tensor_train_(by_tensor_train) {}

  bool factorise(const Sparse& w, const Sparse& cones) override {
    const std::clock_t start = std::clock();
    const Sparse a = w + cones;
    std::vector<Eigen::MatrixXd> root = diagonal_blocks(a, dimension_);
    for (Eigen::MatrixXd& block : root) {
      const Eigen::LLT<Eigen::MatrixXd> cholesky(block);
      if (cholesky.info() != Eigen::Success) return false;
      block = cholesky.matrixL().solve(Eigen::MatrixXd::Identity(dimension_, dimension_));
    }
    scale_ = from_diagonal_blocks(root);
    matrix_ = Sparse(scale_ * a) * Sparse(scale_.transpose());
    if (by_tensor_train_ && !serves_still()) build();
    work_.setup_ms += ms_since(start);
    return true;
  }

  /// A direction that misses the tolerance is still taken: the step to the boundary keeps it harmless.
  bool solve(const VectorXd& rhs, VectorXd& x) override {
    const std::clock_t start = std::clock();
    x = scale_.transpose() * gradients(scale_ * rhs);
    ++work_.solves;
    work_.solve_ms += ms_since(start);
    return x.allFinite();
  }

  LinearWork work() const override { return work_; }

 private:
  static constexpr long kFew = 40;  // gradients: fewer cost less than a new inverse
  static constexpr double kTolerance = 1e-4;
  /// Added to the diagonal before the inverse is taken. The smallest eigenvalues fall to 1e-8 near the end, and an
  /// inverse truncated in its largest directions would be wrong in all others.
  static constexpr double kLeast = 1e-2;
  static constexpr double kNear = 0.5;
  static constexpr Eigen::Index kMaxRank = 32;

  bool serves_still() const { return is_used_ && latest_ <= kFew; }

  void build() {
    if (tree_.place.empty()) tree_ = make_hierarchy(matrix_, dimension_, 2);
    double lift = kLeast;
    TtMatrix train = compress(lifted(lift), tree_, kTolerance, kMaxRank);
    if (const double left_out = largest_difference(train); left_out > 2 * kLeast) {
      lift = left_out;
      train = compress(lifted(lift), tree_, kTolerance, kMaxRank);
    }
    const TtMatrix start = inverse_.core.empty() ? TtMatrix::identity(tree_) : inverse_;
    inverse_ = invert(train, start, {.tolerance = 1e-4, .max_rank = 16, .max_sweeps = 3}).x;
    transposed_ = inverse_.transposed();
    is_used_ = is_inverse();
    work_.bytes = std::max(work_.bytes, inverse_.bytes() + train.bytes());
    work_.rank = std::max<std::ptrdiff_t>(work_.rank, std::max(inverse_.rank(), train.rank()));
    if (is_used_) ++work_.builds;
  }

  VectorXd in_tree(const VectorXd& r) const {
    VectorXd placed = VectorXd::Zero(tree_.size());
    for (Eigen::Index k = 0; k < r.size(); ++k) placed[tree_.place[std::size_t(k)]] = r[k];
    return placed;
  }
  VectorXd from_tree(const VectorXd& image) const {
    VectorXd z(Eigen::Index(tree_.place.size()));
    for (Eigen::Index k = 0; k < z.size(); ++k) z[k] = image[tree_.place[std::size_t(k)]];
    return z;
  }

  /// Whether it takes a vector of changing signs through the matrix and back, to kNear.
  bool is_inverse() const {
    VectorXd v(matrix_.rows());
    for (Eigen::Index k = 0; k < v.size(); ++k) v[k] = std::sin(1.7 * double(k + 1)) < 0 ? -1 : 1;
    return (matrix_ * by_inverse(v) - v).norm() < kNear * v.norm();
  }

  /// The symmetric part of the inverse.
  VectorXd by_inverse(const VectorXd& r) const {
    const VectorXd placed = in_tree(r);
    return from_tree(0.5 * (inverse_.apply(placed) + transposed_.apply(placed)));
  }

  /// About the largest eigenvalue of what the compression left out, by ten steps of the power method.
  double largest_difference(const TtMatrix& train) const {
    VectorXd v = VectorXd::LinSpaced(matrix_.rows(), 1, 2).array().sin();
    double value = 0;
    for (int k = 0; k < 10; ++k) {
      v.normalize();
      v = matrix_ * v - from_tree(train.apply(in_tree(v)));
      value = v.norm();
      if (!(value > 0)) return 0;
    }
    return value;
  }

  /// So that what is left of the matrix after its compression is still positive definite.
  Sparse lifted(double by) const {
    Sparse identity(matrix_.rows(), matrix_.cols());
    identity.setIdentity();
    return matrix_ + by * identity;
  }

  VectorXd preconditioned(const VectorXd& r) const { return is_used_ ? by_inverse(r) : r; }

  /// Flexible conjugate gradients (Notay 2000): the preconditioner is symmetric up to its truncation only.
  VectorXd gradients(const VectorXd& b) {
    constexpr double kTolerance = 1e-10;
    constexpr long kMax = 2000;
    VectorXd x = VectorXd::Zero(b.size()), r = b, p, image;
    double curvature = 0;
    for (latest_ = 0; latest_ < kMax && r.norm() > kTolerance * b.norm(); ++latest_) {
      VectorXd z = preconditioned(r);
      if (latest_ > 0) z -= z.dot(image) / curvature * p;
      p = std::move(z);
      image = matrix_ * p;
      curvature = p.dot(image);
      if (!(curvature > 0)) break;
      const double step = p.dot(r) / curvature;
      x += step * p;
      r -= step * image;
    }
    work_.inner_iterations += latest_;
    return x;
  }

  int dimension_;
  bool by_tensor_train_, is_used_ = false;
  Sparse scale_, matrix_;
  Hierarchy tree_;
  TtMatrix inverse_, transposed_;
  long latest_ = 0;  // gradients of the latest solution
  LinearWork work_;
};

/// L D L^T by fronts of contacts' blocks.
class ByFronts final : public NewtonSystem {
 public:
  explicit ByFronts(int dimension) : factors_(dimension) {}

  bool factorise(const Sparse& w, const Sparse& cones) override { return factors_.factorise(w, cones); }
  bool solve(const VectorXd& rhs, VectorXd& x) override {
    x = rhs;
    factors_.solve(x);
    return x.allFinite();
  }
  LinearWork work() const override { return {.bytes = factors_.bytes(), .multiply_adds = factors_.multiply_adds()}; }

 private:
  BlockLdlt factors_;
};

class General final : public NewtonSystem {
 public:
  bool factorise(const Sparse& w, const Sparse& cones) override {
    const Sparse sum = w + cones;
    if (!has_pattern_of(sum)) keep_pattern_of(sum);
    factors_.factorize(sum);
    return factors_.info() == Eigen::Success;
  }
  bool solve(const VectorXd& rhs, VectorXd& x) override {
    x = factors_.solve(rhs);
    return x.allFinite();
  }

 private:
  /// Steps of one problem share their pattern, so ordering and symbolic analysis are done once.
  bool has_pattern_of(const Sparse& a) const {
    return std::equal(begin_.begin(), begin_.end(), a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1) &&
           std::equal(inner_.begin(), inner_.end(), a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros());
  }
  void keep_pattern_of(const Sparse& a) {
    begin_.assign(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1);
    inner_.assign(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros());
    factors_.analyzePattern(a);
  }

  Eigen::SparseLU<Sparse> factors_;
  std::vector<Sparse::StorageIndex> begin_, inner_;
};

class Krylov final : public NewtonSystem {
 public:
  explicit Krylov(bool preconditioned) : method_(settings(preconditioned)) {}

  bool factorise(const Sparse& w, const Sparse& cones) override {
    method_.factorise(Sparse(w + cones));
    return true;
  }
  /// A direction that misses the tolerance is still taken: the step to the boundary keeps it harmless.
  bool solve(const VectorXd& rhs, VectorXd& x) override {
    method_.solve(rhs, x);
    return x.allFinite();
  }
  LinearWork work() const override { return method_.work(); }

 private:
  static PreconditionerSettings settings(bool preconditioned) {
    PreconditionerSettings s;
    s.is_used = preconditioned;
    s.is_single = false;  // near the end the condition of Newton's matrix exceeds what float holds
    s.tolerance = 1e-12;
    return s;
  }
  PreconditionedKrylov method_;
};

}  // namespace

std::unique_ptr<NewtonSystem> make_newton_system(NewtonKind kind, bool is_symmetric, const LocalProblem& problem,
                                                 const ScaledProblem& of, const std::vector<char>& fixed) {
  switch (kind) {
    case NewtonKind::bodies:
      return make_system_by_bodies(problem, of, fixed, is_symmetric);
    case NewtonKind::blocks:
    case NewtonKind::tensor_train:
      return std::make_unique<BlockSystem>(problem.dimension, kind == NewtonKind::tensor_train);
    case NewtonKind::spike:
    case NewtonKind::krylov:
      return std::make_unique<Krylov>(kind == NewtonKind::spike);
    case NewtonKind::direct:
      break;
  }
  if (is_symmetric && (!problem.is_whole || has_hubs(problem)))
    return std::make_unique<WithoutHubs>(scaled_form(problem, of, fixed), hubs_of(problem), problem.dimension);
  if (is_symmetric) return std::make_unique<ByFronts>(problem.dimension);
  return std::make_unique<General>();
}

}  // namespace gonogo::sim
