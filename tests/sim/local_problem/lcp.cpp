// Linear complementarity problems: every method against enumeration of all complementary bases.
#include "sim/local_problem/algebra/lcp.h"

#include <random>

#include "tests/support/catch.h"

using namespace gonogo::sim;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Lcp make(const MatrixXd& m, const VectorXd& q) { return {m.sparseView(), q}; }

/// All solutions at vertices: for every choice of the positive unknowns one linear system.
std::vector<VectorXd> enumerate(const MatrixXd& m, const VectorXd& q) {
  const int n = int(q.size());
  std::vector<VectorXd> found;
  for (int basis = 0; basis < 1 << n; ++basis) {
    MatrixXd rows = MatrixXd::Identity(n, n);
    VectorXd rhs = VectorXd::Zero(n);
    for (int i = 0; i < n; ++i)
      if (basis >> i & 1) rows.row(i) = m.row(i), rhs[i] = -q[i];
    const Eigen::FullPivLU<MatrixXd> lu(rows);
    if (!lu.isInvertible()) continue;
    const VectorXd x = lu.solve(rhs), w = m * x + q;
    if (x.minCoeff() >= -1e-10 && w.minCoeff() >= -1e-10) found.push_back(x);
  }
  return found;
}

double distance(const std::vector<VectorXd>& all, const VectorXd& x) {
  double nearest = 1e300;
  for (const VectorXd& known : all) nearest = std::min(nearest, (known - x).norm());
  return nearest;
}

struct Draw {
  std::mt19937 generator;
  explicit Draw(unsigned seed) : generator(seed) {}
  MatrixXd matrix(int rows, int columns) {
    std::normal_distribution<double> normal;
    MatrixXd m(rows, columns);
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j) m(i, j) = normal(generator);
    return m;
  }
};

}  // namespace

TEST_CASE("positive definite problems: every method finds the one solution that enumeration finds") {
  Draw draw(5);
  for (int k = 0; k < 100; ++k) {
    const int n = 2 + k % 7;
    const MatrixXd h = draw.matrix(n + 2, n), skew = draw.matrix(n, n);
    const VectorXd q = draw.matrix(n, 1);
    const MatrixXd symmetric = h.transpose() * h;
    for (const bool is_symmetric : {true, false}) {
      const MatrixXd m = is_symmetric ? symmetric : MatrixXd(symmetric + skew - skew.transpose());
      const auto known = enumerate(m, q);
      REQUIRE(!known.empty());
      const Lcp lcp = make(m, q);
      INFO("problem " << k << (is_symmetric ? " symmetric" : " not symmetric"));
      CHECK(distance(known, solve_lemke(lcp).x) < 1e-8 * (1 + known[0].norm()));
      CHECK(distance(known, solve_fb_newton(lcp).x) < 1e-7 * (1 + known[0].norm()));
      if (!is_symmetric) continue;
      CHECK(distance(known, solve_qp(lcp).x) < 1e-8 * (1 + known[0].norm()));
      const LcpSolution swept = solve_pgs(lcp, {1e-12, 200000});
      CHECK(distance(known, swept.x) < 1e-5 * (1 + known[0].norm()));
    }
  }
}

TEST_CASE("semidefinite problems of low rank have many solutions; every method finds one") {
  Draw draw(6);
  for (int k = 0; k < 50; ++k) {
    const int n = 12;
    const MatrixXd h = draw.matrix(4, n);
    const VectorXd q = h.transpose() * draw.matrix(4, 1);  // in the range: a solution exists
    const Lcp lcp = make(h.transpose() * h, q);
    INFO("problem " << k);
    for (const LcpSolution& x : {solve_lemke(lcp), solve_qp(lcp), solve_fb_newton(lcp, {1e-9, 0})}) {
      CHECK(x.status == LcpStatus::solved);
      CHECK(natural_error(lcp, x.x) < 1e-8);
      CHECK(x.x.minCoeff() >= 0);
    }
    CHECK(natural_error(lcp, solve_pgs(lcp, {1e-6, 0}).x) < 1e-6);
  }
}

TEST_CASE("Lemke's method leaves the cycle that its plain form falls into, and stops at equal ratios") {
  // Kostreva (1979): all ratios tie; without a rule against cycling the same bases come back for ever.
  const MatrixXd m = (Eigen::Matrix3d() << 1, 2, 0, 0, 1, 2, 2, 0, 1).finished();
  const LcpSolution x = solve_lemke(make(m, -VectorXd::Ones(3)));
  CHECK(x.status == LcpStatus::solved);
  CHECK((x.x - VectorXd::Constant(3, 1.0 / 3)).norm() < 1e-14);
  Draw draw(8);  // equal bodies at rest on each other: rows and right-hand sides repeat
  for (int k = 0; k < 40; ++k) {
    const MatrixXd h = draw.matrix(3, 4), repeated = h.replicate(1, 3);
    const VectorXd q = (h.transpose() * draw.matrix(3, 1)).replicate(3, 1);
    const LcpSolution many = solve_lemke(make(repeated.transpose() * repeated, q));
    CHECK(many.status == LcpStatus::solved);
  }
}

TEST_CASE("a problem without a solution is said to have none") {
  const MatrixXd m = MatrixXd::Zero(2, 2);
  const Lcp lcp = make(m, Eigen::Vector2d(1, -1));
  CHECK(solve_lemke(lcp).status == LcpStatus::ray);
  CHECK(solve_qp(lcp).status == LcpStatus::ray);
  CHECK(solve_fb_newton(lcp).status == LcpStatus::iterations);
  CHECK(natural_error(lcp, solve_fb_newton(lcp).x) > 0.1);
}

TEST_CASE("exponentially long for pivots: Murty's triangular problem is still solved") {
  const int n = 10;  // M = 2 below the diagonal, 1 on it; q = -1: the solution is the last unit vector
  MatrixXd m = MatrixXd::Identity(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) m(i, j) = 2;
  VectorXd expected = VectorXd::Zero(n);
  expected[n - 1] = 1;
  const Lcp lcp = make(m, -VectorXd::Ones(n));
  CHECK((solve_lemke(lcp).x - expected).norm() < 1e-12);
  CHECK((solve_fb_newton(lcp).x - expected).norm() < 1e-8);
}
