// The cone program solver: optimality is checked from the answer alone, and against closed forms and enumeration.
#include <cmath>
#include <random>

#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "vehicle/feasible/cone_program.h"

using namespace gonogo::vehicle;
using gonogo::test::agrees;

namespace {

struct Draw {
  std::mt19937 engine{17};
  double operator()() { return std::uniform_real_distribution<double>(-1, 1)(engine); }
  Eigen::VectorXd vector(int n) {
    Eigen::VectorXd v(n);
    for (int i = 0; i < n; ++i) v(i) = (*this)();
    return v;
  }
  Eigen::MatrixXd matrix(int rows, int columns) {
    Eigen::MatrixXd m(rows, columns);
    for (int i = 0; i < rows; ++i) m.row(i) = vector(columns);
    return m;
  }
};

/// A point inside all cones.
Eigen::VectorXd inside(Draw& draw, const std::vector<int>& cone) {
  Eigen::VectorXd s;
  for (const int n : cone) {
    Eigen::VectorXd part = draw.vector(n);
    part(0) = part.tail(n - 1).norm() + 0.3 + std::fabs(draw());
    Eigen::VectorXd longer(s.size() + n);
    longer << s, part;
    s = longer;
  }
  return s;
}

/// How far outside the cones a vector is.
double outside(const std::vector<int>& cone, const Eigen::VectorXd& s) {
  double worst = 0;
  int at = 0;
  for (const int n : cone) {
    worst = std::max(worst, s.segment(at + 1, n - 1).norm() - s(at));
    at += n;
  }
  return worst;
}

/// Best vertex of a linear program by trying every set of active rows.
double by_enumeration(const ConeProgram& p) {
  const int n = int(p.c.size()), rows = int(p.h.size());
  double best = 1e300;
  std::vector<int> pick(n);
  for (int i = 0; i < n; ++i) pick[i] = i;
  for (;;) {
    Eigen::MatrixXd active(n, n);
    Eigen::VectorXd right(n);
    for (int i = 0; i < n; ++i) {
      active.row(i) = p.G.row(pick[i]);
      right(i) = p.h(pick[i]);
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(active);
    if (lu.isInvertible()) {
      const Eigen::VectorXd x = lu.solve(right);
      if ((p.h - p.G * x).minCoeff() > -1e-9) best = std::min(best, p.c.dot(x));
    }
    int i = n - 1;
    while (i >= 0 && pick[i] == rows - n + i) --i;
    if (i < 0) return best;
    ++pick[i];
    for (int j = i + 1; j < n; ++j) pick[j] = pick[j - 1] + 1;
  }
}

}  // namespace

TEST_CASE("answers of random cone programs meet the conditions of optimality") {
  Draw draw;
  double residual = 0, gap = 0, out = 0;
  for (int trial = 0; trial < 200; ++trial) {
    ConeProgram p;
    for (int i = 0; i < 2 + trial % 6; ++i) p.cone.push_back(1 + (trial + i) % 4);
    const Eigen::VectorXd s = inside(draw, p.cone), z = inside(draw, p.cone);
    const int n = std::max(2, int(s.size()) - 2), m = n / 3;
    p.G = draw.matrix(int(s.size()), n);
    p.A = draw.matrix(m, n);
    // Interior points of the program and of its dual, so that both have answers.
    const Eigen::VectorXd x = draw.vector(n), y = draw.vector(m);
    p.h = p.G * x + s;
    p.b = p.A * x;
    p.c = -(p.A.transpose() * y + p.G.transpose() * z);
    if (trial % 5 == 0 && m > 0) {  // an equation twice
      Eigen::MatrixXd twice(m + 1, n);
      twice << p.A, 2 * p.A.row(0);
      Eigen::VectorXd right(m + 1);
      right << p.b, 2 * p.b(0);
      p.A = twice;
      p.b = right;
    }
    const ConeAnswer a = solve(p);
    REQUIRE(a.solved);
    residual = std::max({residual, (p.G * a.x + a.s - p.h).cwiseAbs().maxCoeff(),
                         m > 0 ? (p.A * a.x - p.b).cwiseAbs().maxCoeff() : 0.0});
    gap = std::max(gap, std::fabs(a.s.dot(a.z)) / (1 + std::fabs(p.c.dot(a.x))));
    out = std::max({out, outside(p.cone, a.s), outside(p.cone, a.z)});
    // Weak duality: no point of the program is better than the dual's value.
    CHECK(p.c.dot(x) > p.c.dot(a.x) - 1e-7);
  }
  CHECK(agrees("equations of the answers", 0, residual, 1e-8));
  CHECK(agrees("gap to the dual over the value", 0, gap, 1e-8));
  CHECK(agrees("outside the cones", 0, out, 1e-9));
}

TEST_CASE("linear programs end in their best vertex") {
  Draw draw;
  double worst = 0;
  for (int trial = 0; trial < 30; ++trial) {
    ConeProgram p;
    const int n = 3, rows = 10;
    p.G = Eigen::MatrixXd(rows, n);
    p.G << draw.matrix(rows - 2 * n, n), Eigen::MatrixXd::Identity(n, n), -Eigen::MatrixXd::Identity(n, n);
    p.h = Eigen::VectorXd::Constant(rows, 1);
    p.A = Eigen::MatrixXd(0, n);
    p.b = Eigen::VectorXd(0);
    p.c = draw.vector(n);
    p.cone.assign(rows, 1);
    const ConeAnswer a = solve(p);
    REQUIRE(a.solved);
    worst = std::max(worst, std::fabs(p.c.dot(a.x) - by_enumeration(p)));
  }
  CHECK(agrees("value against all vertices", 0, worst, 1e-8));
}

TEST_CASE("the nearest point of a cone is the closed form's") {
  Draw draw;
  for (int trial = 0; trial < 30; ++trial) {
    // minimise t with |x - p| <= t and |x1..| <= x0.
    const Eigen::VectorXd point = 2 * draw.vector(3);
    ConeProgram p;
    p.cone = {4, 3};
    p.G = Eigen::MatrixXd::Zero(7, 4);
    p.G.topLeftCorner(4, 4) = -Eigen::MatrixXd::Identity(4, 4);
    p.G.block(4, 1, 3, 3) = -Eigen::MatrixXd::Identity(3, 3);
    p.h = Eigen::VectorXd::Zero(7);
    p.h.segment(1, 3) = -point;
    p.c = Eigen::VectorXd::Unit(4, 0);
    p.A = Eigen::MatrixXd(0, 4);
    p.b = Eigen::VectorXd(0);
    const double tail = point.tail(2).norm();
    const double expected = tail <= point(0) ? 0 : tail <= -point(0) ? point.norm() : (tail - point(0)) / std::sqrt(2);
    CHECK(std::fabs(solve(p).x(0) - expected) < 1e-7);
  }
}

TEST_CASE("equations that contradict each other are noticed") {
  ConeProgram p;
  p.c = Eigen::VectorXd::Unit(2, 0);
  p.A = Eigen::MatrixXd::Ones(2, 2);
  p.b = Eigen::VectorXd(2);
  p.b << 1, 2;
  p.G = -Eigen::MatrixXd::Identity(2, 2);
  p.h = Eigen::VectorXd::Zero(2);
  p.cone = {1, 1};
  CHECK(!solve(p).consistent);
}
