#include "sim/local_problem/hub_system.h"

#include <Eigen/Dense>
#include <algorithm>

#include "sim/local_problem/block_ldlt.h"
#include "sim/local_problem/scaled_form.h"

namespace gonogo::sim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

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

}  // namespace

bool has_hubs(const LocalProblem& problem) {
  if (!problem.bodies) return false;
  const std::vector<char> is_hub = hubs_of(problem);
  return std::count(is_hub.begin(), is_hub.end(), 1) > 0;
}

std::unique_ptr<NewtonSystem> make_system_without_hubs(const LocalProblem& problem, const ScaledProblem& of,
                                                       const std::vector<char>& fixed) {
  return std::make_unique<WithoutHubs>(scaled_form(problem, of, fixed), hubs_of(problem), problem.dimension);
}

}  // namespace gonogo::sim
