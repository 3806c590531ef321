#include "sim/local_problem/newton_system.h"

#include <Eigen/SparseLU>
#include <algorithm>
#include <vector>

#include "sim/local_problem/banded/spike_preconditioner.h"
#include "sim/local_problem/block_ldlt.h"
#include "sim/local_problem/by_bodies.h"
#include "sim/local_problem/hub_system.h"
#include "sim/local_problem/tt_system.h"

namespace gonogo::sim {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

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
  LinearWork work() const override {
    const KrylovWork& work = method_.work();
    return {.solves = work.solves,
            .inner_iterations = work.inner_iterations,
            .setup_ms = work.setup_ms,
            .solve_ms = work.solve_ms,
            .bytes = work.bytes,
            .half = work.half,
            .full_half = work.full_half,
            .partitions = work.partitions,
            .dropped = work.dropped};
  }

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

std::unique_ptr<NewtonSystem> make_newton_system(LocalSolver solver, bool is_symmetric, const LocalProblem& problem,
                                                 const ScaledProblem& of, const std::vector<char>& fixed) {
  if (solver == LocalSolver::pdip_bodies) return make_system_by_bodies(problem, of, fixed, is_symmetric);
  if (solver == LocalSolver::pdip_blocks || solver == LocalSolver::pdip_tt)
    return make_block_system(problem.dimension, solver == LocalSolver::pdip_tt);
  if (solver != LocalSolver::pdip) return std::make_unique<Krylov>(solver == LocalSolver::pdip_spike);
  if (is_symmetric && (!problem.is_whole || has_hubs(problem))) return make_system_without_hubs(problem, of, fixed);
  if (is_symmetric) return std::make_unique<ByFronts>(problem.dimension);
  return std::make_unique<General>();
}

}  // namespace gonogo::sim
