// Tensor trains of sparse matrices and of their inverses, against dense matrices.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "sim/local_problem/algebra/tensor_train.h"
#include "sim/local_problem/methods/solve.h"
#include "tests/support/catch.h"

using namespace gonogo::sim;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

/// Blocks of `block` rows along a shuffled chain; `spread`: how far couplings differ.
Sparse chain(Index nodes, int block, double spread) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(1 - spread, 1);
  std::vector<Index> place(std::size_t(nodes), 0);
  std::iota(place.begin(), place.end(), Index(0));
  std::shuffle(place.begin(), place.end(), generator);
  std::vector<Eigen::Triplet<double>> entry;
  for (Index k = 0; k < nodes; ++k)
    for (int a = 0; a < block; ++a) {
      const Index row = place[std::size_t(k)] * block + a;
      entry.emplace_back(row, row, 2.5);
      if (k + 1 == nodes) continue;
      const Index next = place[std::size_t(k + 1)] * block + a;
      const double coupling = -uniform(generator);
      entry.emplace_back(row, next, coupling);
      entry.emplace_back(next, row, coupling);
    }
  Sparse a(nodes * block, nodes * block);
  a.setFromTriplets(entry.begin(), entry.end());
  return a;
}

/// In the tree's order, filled up with ones.
MatrixXd placed(const Sparse& a, const Hierarchy& tree) {
  MatrixXd out = MatrixXd::Identity(tree.size(), tree.size());
  const MatrixXd dense = a;
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < a.cols(); ++j) out(tree.place[std::size_t(i)], tree.place[std::size_t(j)]) = dense(i, j);
  return out;
}

}  // namespace

TEST_CASE("the hierarchy gives every row one place and cuts a shuffled chain into runs") {
  for (const Index nodes : {1, 2, 5, 64, 100}) {
    const Sparse a = chain(nodes, 3, 0);
    const Hierarchy tree = make_hierarchy(a, 3, 4);
    CHECK(tree.levels >= 1);
    CHECK(tree.leaf_rows <= 12);
    std::vector<Index> sorted = tree.place;
    std::sort(sorted.begin(), sorted.end());
    CHECK(std::unique(sorted.begin(), sorted.end()) == sorted.end());
    CHECK(sorted.back() < tree.size());
    // Every halving of a chain cuts it once: couplings between leaves are as few as the leaves.
    Index cut = 0;
    for (Index k = 0; k < a.outerSize(); ++k)
      for (Sparse::InnerIterator it(a, k); it; ++it)
        cut += tree.place[std::size_t(it.row())] / tree.leaf_rows != tree.place[std::size_t(it.col())] / tree.leaf_rows;
    CHECK(cut <= 2 * 3 * ((Index(1) << tree.levels) - 1));
  }
}

TEST_CASE("a compressed matrix is the dense one to its tolerance, and its product with a vector too") {
  for (const double spread : {0.0, 0.5}) {
    const Sparse a = chain(50, 3, spread);
    const Hierarchy tree = make_hierarchy(a, 3, 4);
    const MatrixXd dense = placed(a, tree);
    const VectorXd x = VectorXd::LinSpaced(tree.size(), -1, 2);
    double before = 0;
    for (const double tolerance : {1e-1, 1e-3, 1e-6}) {
      const TtMatrix train = compress(a, tree, tolerance, 1000);
      INFO("spread " << spread << " tolerance " << tolerance << " rank " << train.rank());
      CHECK(train.size() == tree.size());
      CHECK((train.dense() - dense).norm() <= tolerance * dense.norm());
      CHECK((train.transposed().dense() - train.dense().transpose()).norm() <= 1e-14 * dense.norm());
      CHECK((train.apply(x) - train.dense() * x).norm() <= 1e-12 * x.norm() * dense.norm());
      CHECK(double(train.rank()) >= before);
      before = double(train.rank());
    }
  }
}

TEST_CASE("the rank of a regular chain does not grow with its length") {
  Index rank[2];
  for (int k = 0; k < 2; ++k) {
    const Sparse a = chain(k == 0 ? 64 : 1024, 3, 0);
    const TtMatrix train = compress(a, make_hierarchy(a, 3, 4), 1e-6, 1000);
    rank[k] = train.rank();
  }
  CHECK(rank[1] <= rank[0] + 2);
}

TEST_CASE("the inverse as a tensor train is the dense inverse") {
  for (const double spread : {0.0, 0.3}) {
    const Sparse a = chain(40, 3, spread);
    const Hierarchy tree = make_hierarchy(a, 3, 4);
    const TtMatrix train = compress(a, tree, 1e-7, 1000);
    const MatrixXd inverse = placed(a, tree).inverse();
    const TtInverse found = invert(train, TtMatrix::identity(tree), {1e-6, 40, 8});
    INFO("spread " << spread << " rank " << found.x.rank() << " sweeps " << found.sweeps << " residual "
                   << found.residual);
    CHECK(found.residual < 1e-4);
    CHECK((found.x.dense() - inverse).norm() < 1e-4 * inverse.norm());
    // From itself it has nothing to do, and few sweeps from that of a matrix nearby.
    CHECK(invert(train, found.x, {1e-4, 40, 8}).sweeps == 0);
    CHECK(invert(compress(chain(40, 3, spread + 0.05), tree, 1e-7, 1000), found.x, {1e-4, 40, 8}).sweeps <=
          found.sweeps);
  }
}

TEST_CASE("an inverse of low rank draws the eigenvalues to 1") {
  const Sparse a = chain(100, 3, 0.05);
  const Hierarchy tree = make_hierarchy(a, 3, 2);
  const TtMatrix inverse = invert(compress(a, tree, 1e-3, 32), TtMatrix::identity(tree), {1e-3, 12, 4}).x;
  const MatrixXd product = inverse.dense() * placed(a, tree);
  const VectorXd values = product.eigenvalues().real();
  INFO("rank " << inverse.rank() << ", eigenvalues " << values.minCoeff() << " to " << values.maxCoeff());
  CHECK(inverse.rank() <= 12);
  CHECK(values.minCoeff() > 0.5);  // without the inverse: 0.5 to 4.5
  CHECK(values.maxCoeff() < 1.5);
}

TEST_CASE("the interior point by tensor trains finds the impulses") {
  const Sparse w = chain(200, 3, 0.2);
  std::vector<gonogo::sim::Triplet> entry;
  for (Index k = 0; k < w.outerSize(); ++k)
    for (Sparse::InnerIterator it(w, k); it; ++it)
      entry.push_back({gonogo::Index(it.row()), gonogo::Index(it.col()), it.value()});
  std::vector<double> q;
  for (Index k = 0; k < w.rows(); ++k) q.push_back(std::sin(1.7 * double(k)) - (k % 3 == 0 ? 1 : 0));
  const LocalProblem p = make_problem("chain", 3, entry, q, std::vector<double>(200, 0.5));
  const LocalSolution tt = solve(p, {local_solver("pdip_tt"), Target::ccp, 1e-6, 0});
  const LocalSolution blocks = solve(p, {local_solver("pdip_blocks"), Target::ccp, 1e-6, 0});
  const LocalSolution direct = solve(p, {local_solver("pdip"), Target::ccp, 1e-6, 0});
  for (const LocalSolution& x : {tt, blocks, direct}) {
    CHECK(x.error <= 1e-6);
    for (std::size_t i = 0; i < x.r.size(); ++i) CHECK(x.r[i] == Approx(direct.r[i]).margin(1e-3));
  }
  CHECK(tt.linear.rank > 1);
  CHECK(tt.linear.bytes > 0);
  CHECK(tt.linear.builds >= 1);
  CHECK(tt.linear.builds <= tt.iterations);
  CHECK(blocks.linear.builds == 0);
  CHECK(tt.linear.inner_iterations < blocks.linear.inner_iterations);
  CHECK(solve(p, {local_solver("pdip_tt"), Target::coulomb, 1e-6, 0}).refusal.find("refuses coulomb") !=
        std::string::npos);
}
