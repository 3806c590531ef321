#include "sim/local_problem/by_bodies.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include "sim/local_problem/block_diagonal.h"
#include "sim/local_problem/body_form.h"

namespace gonogo::sim {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// B in the units of `of`, without the rows that stay 0.
Sparse scaled_form(const LocalProblem& p, const ScaledProblem& of, const std::vector<char>& fixed) {
  constexpr int kFreedoms = BodyForm::kFreedoms;
  std::vector<Eigen::Triplet<double>> entry;
  for (Index i = 0; i < p.contact_count(); ++i) {
    const BodyForm::Contact& c = p.bodies->contact[std::size_t(i)];
    for (int k = 0; k < 2; ++k)
      for (int a = 0; a < p.dimension && c.body[k] >= 0; ++a) {
        const Index row = i * p.dimension + a;
        for (int f = 0; f < kFreedoms && !fixed[std::size_t(row)]; ++f)
          if (c.row[k][a][f] != 0) entry.emplace_back(row, c.body[k] * kFreedoms + f, of.unit[row] * c.row[k][a][f]);
      }
  }
  Sparse b(Eigen::Index(p.q.size()), Eigen::Index(p.bodies->body_count) * kFreedoms);
  b.setFromTriplets(entry.begin(), entry.end());
  return b;
}

template <class Factors>
class ByBodies final : public NewtonSystem {
 public:
  ByBodies(Sparse b, int dimension) : b_(std::move(b)), transposed_(b_.transpose()), dimension_(dimension) {}

  bool factorise(const Sparse& w, const Sparse& cones) override {
    w_ = &w;
    cones_ = cones;
    inverse_ = inverse_blocks(cones, dimension_);
    const Sparse scaled = inverse_ * b_;
    Sparse matrix = transposed_ * scaled;
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) matrix.coeffRef(k, k) += 1;
    factors_.compute(matrix);
    return factors_.info() == Eigen::Success;
  }

  /// The difference of two large terms where C is large; refined against the matrix itself.
  bool solve(const VectorXd& rhs, VectorXd& x) override {
    constexpr int kRefinements = 3;
    constexpr double kEnough = 1e-13;
    x = once(rhs);
    for (int k = 0; k < kRefinements; ++k) {
      const VectorXd left = rhs - *w_ * x - cones_ * x;
      if (!(left.norm() > kEnough * rhs.norm())) break;
      x += once(left);
    }
    return x.allFinite();
  }

 private:
  VectorXd once(const VectorXd& rhs) const {
    const VectorXd y = inverse_ * rhs;
    const VectorXd motion = factors_.solve(VectorXd(transposed_ * y));
    return y - inverse_ * VectorXd(b_ * motion);
  }

  Sparse b_, transposed_, cones_, inverse_;
  const Sparse* w_ = nullptr;
  int dimension_;
  Factors factors_;
};

}  // namespace

std::unique_ptr<NewtonSystem> make_system_by_bodies(const LocalProblem& problem, const ScaledProblem& of,
                                                    const std::vector<char>& fixed, bool is_symmetric) {
  Sparse b = scaled_form(problem, of, fixed);
  if (is_symmetric) return std::make_unique<ByBodies<Eigen::SimplicialLDLT<Sparse>>>(std::move(b), problem.dimension);
  return std::make_unique<ByBodies<Eigen::SparseLU<Sparse>>>(std::move(b), problem.dimension);
}

}  // namespace gonogo::sim
