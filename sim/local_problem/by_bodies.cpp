#include "sim/local_problem/by_bodies.h"

#include <Eigen/SparseLU>

#include "sim/local_problem/block_diagonal.h"
#include "sim/local_problem/block_ldlt.h"
#include "sim/local_problem/scaled_form.h"

namespace gonogo::sim {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

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

}  // namespace

std::unique_ptr<NewtonSystem> make_system_by_bodies(const LocalProblem& problem, const ScaledProblem& of,
                                                    const std::vector<char>& fixed, bool is_symmetric) {
  const Sparse b = scaled_form(problem, of, fixed);
  if (is_symmetric) return std::make_unique<ByBodies<Fronts>>(b, problem.dimension);
  return std::make_unique<ByBodies<Eigen::SparseLU<Sparse>>>(b, problem.dimension);
}

}  // namespace gonogo::sim
