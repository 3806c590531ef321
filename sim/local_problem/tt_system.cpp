#include "sim/local_problem/tt_system.h"

#include "sim/local_problem/block_diagonal.h"
#include "sim/local_problem/tensor_train/tt_inverse.h"

namespace gonogo::sim {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

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

}  // namespace

std::unique_ptr<NewtonSystem> make_block_system(int dimension, bool by_tensor_train) {
  return std::make_unique<BlockSystem>(dimension, by_tensor_train);
}

}  // namespace gonogo::sim
