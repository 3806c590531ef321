// Local problems: cone, residual and solvers against closed forms and against enumeration of all contact states.
#include "sim/local_problem/problem.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <random>

#include "sim/local_problem/methods/solve.h"
#include "sim/local_problem/one_contact.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::sim;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const std::array kTargets = {Target::coulomb, Target::ccp};

LocalProblem make(int dimension, const MatrixXd& w, const VectorXd& q, std::vector<double> mu,
                  std::vector<double> mu_roll = {}) {
  std::vector<Triplet> entry;
  for (Index i = 0; i < w.rows(); ++i)
    for (Index j = 0; j < w.cols(); ++j) entry.push_back({i, j, w(i, j)});
  return make_problem("test", dimension, entry, {q.begin(), q.end()}, std::move(mu), std::move(mu_roll));
}

struct Draw {
  std::mt19937 generator;
  std::normal_distribution<double> normal;
  explicit Draw(unsigned seed) : generator(seed) {}
  double number() { return normal(generator); }
  VectorXd vector(int size) {
    VectorXd v(size);
    for (double& x : v) x = number();
    return v;
  }
  /// H^T H with `freedoms` rows: of lower rank than `size` when there are fewer.
  MatrixXd delassus(int size, int freedoms) {
    MatrixXd h(freedoms, size);
    for (int i = 0; i < freedoms; ++i)
      for (int j = 0; j < size; ++j) h(i, j) = number();
    return h.transpose() * h;
  }
};

std::vector<double> one(const LocalProblem& p, Target target) {
  std::vector<double> r(p.q.size(), 0.0);
  solve_one_contact(p, 0, target, p.diagonal_block(0), p.q.data(), r.data());
  return r;
}

/// All exact solutions in the plane: each contact open, sticking, or sliding either way, one linear system per choice.
std::vector<VectorXd> enumerate(const MatrixXd& w, const VectorXd& q, const std::vector<double>& mu, Target target) {
  const int contacts = int(mu.size());
  std::vector<VectorXd> found;
  for (int code = 0; code < std::pow(4, contacts); ++code) {
    MatrixXd rows = MatrixXd::Zero(2 * contacts, 2 * contacts);
    VectorXd rhs = VectorXd::Zero(2 * contacts);
    const auto state = [&](int c) {
      return code / int(std::pow(4, c)) % 4;
    };  // 0 open, 1 stick, 2 slip > 0, 3 slip < 0
    for (int c = 0; c < contacts; ++c) {
      const int n = 2 * c, t = n + 1, sign = state(c) == 2 ? 1 : -1;
      if (state(c) == 0) {
        rows(n, n) = rows(t, t) = 1;
        continue;
      }
      const double lift = target == Target::ccp && state(c) > 1 ? mu[c] * sign : 0;  // u_n = mu |u_t|
      rows.row(n) = w.row(n) - lift * w.row(t);
      rhs[n] = -q[n] + lift * q[t];
      if (state(c) == 1) {
        rows.row(t) = w.row(t);
        rhs[t] = -q[t];
      } else {
        rows(t, t) = 1;
        rows(t, n) = mu[c] * sign;
      }
    }
    const VectorXd r = rows.fullPivLu().solve(rhs), u = w * r + q;
    bool holds = (rows * r - rhs).norm() < 1e-9;
    for (int c = 0; c < contacts; ++c) {
      const double r_n = r[2 * c], r_t = r[2 * c + 1], u_n = u[2 * c], u_t = u[2 * c + 1], none = 1e-12;
      const double lift = target == Target::ccp ? mu[c] * std::abs(u_t) : 0;
      holds = holds && r_n >= -none && std::abs(r_t) <= mu[c] * r_n + none && u_n >= lift - 1e-9;
      holds = holds && (state(c) != 2 || u_t >= -none) && (state(c) != 3 || u_t <= none);
    }
    if (holds) found.push_back(r);
  }
  return found;
}

double distance(const std::vector<VectorXd>& all, const std::vector<double>& r) {
  double nearest = 1e300;
  for (const VectorXd& x : all)
    nearest = std::min(nearest, (x - Eigen::Map<const VectorXd>(r.data(), Eigen::Index(r.size()))).norm());
  return nearest;
}

}  // namespace

TEST_CASE("the projection is the nearest admissible impulse, with and without rolling") {
  Draw draw(3);
  for (const int d : {2, 3, 5})
    for (int k = 0; k < 2000; ++k) {
      const double mu = std::abs(draw.number()), mu_roll = std::abs(draw.number());
      const LocalProblem p = make(d, MatrixXd::Identity(d, d), VectorXd::Zero(d), {mu},
                                  d == 5 ? std::vector{mu_roll} : std::vector<double>{});
      const VectorXd before = draw.vector(d);
      VectorXd r = before;
      project_onto_cone(p, 0, r.data());
      const int t = d == 2 ? 1 : 2;
      CHECK(r.segment(1, t).norm() <= mu * r[0] + 1e-14);
      if (d == 5) CHECK(r.tail(2).norm() <= mu_roll * r[0] + 1e-14);
      CHECK(std::abs((before - r).dot(r)) < 1e-13);  // orthogonal, and no admissible direction is closer:
      VectorXd other(d);
      other[0] = 1;
      other.segment(1, t) = mu * draw.vector(t).normalized();
      if (d == 5) other.tail(2) = mu_roll * draw.vector(2).normalized();
      CHECK((before - r).dot(other) < 1e-13);
    }
}

TEST_CASE("one contact with equal, uncoupled inertias: closed forms of open, stick and slide") {
  const double w = 4, mu = 0.5;
  const MatrixXd block = w * MatrixXd::Identity(3, 3);
  const auto solve_for = [&](const VectorXd& q, Target target) { return one(make(3, block, q, {mu}), target); };
  for (const Target target : kTargets) {
    CHECK(solve_for(Eigen::Vector3d(2, 3, 0), target) == std::vector<double>{0, 0, 0});  // leaves faster than mu |q_t|
    const auto stick = solve_for(Eigen::Vector3d(-2, 0.6, -0.7), target);
    CHECK(stick[0] == Approx(0.5).epsilon(1e-13));
    CHECK(stick[1] == Approx(-0.15).epsilon(1e-13));
    CHECK(stick[2] == Approx(0.175).epsilon(1e-13));
  }
  // Slide at q = (-2, 3, 4): Coulomb r_n = 2 / w, r_t = -mu r_n (3, 4) / 5; CCP is the projection of -q / w.
  const auto coulomb = solve_for(Eigen::Vector3d(-2, 3, 4), Target::coulomb);
  const double r_n = (2 + mu * 5) / (1 + mu * mu) / w;
  const auto ccp = solve_for(Eigen::Vector3d(-2, 3, 4), Target::ccp);
  for (const auto& [r, n] : {std::pair(coulomb, 2 / w), {ccp, r_n}}) {
    CHECK(r[0] == Approx(n).epsilon(1e-13));
    CHECK(r[1] == Approx(-mu * n * 0.6).epsilon(1e-13));
    CHECK(r[2] == Approx(-mu * n * 0.8).epsilon(1e-13));
  }
  // Between the two: at q = (1, 3, 0) Coulomb opens, the relaxation pulls to reach u_n = mu |u_t|.
  CHECK(solve_for(Eigen::Vector3d(1, 3, 0), Target::coulomb)[0] == 0);
  CHECK(solve_for(Eigen::Vector3d(1, 3, 0), Target::ccp)[0] == Approx((-1 + mu * 3) / (1 + mu * mu) / w));
}

TEST_CASE("one contact of any inertia, in the plane, in space and with rolling, is solved to rounding") {
  Draw draw(7);
  for (const Target target : kTargets)
    for (const int d : {2, 3, 5})
      for (int k = 0; k < (d == 5 ? 400 : 2000); ++k) {
        const std::vector<double> mu_roll = d == 5 ? std::vector{std::abs(draw.number())} : std::vector<double>{};
        const double mu = k % 20 == 0 ? 0 : std::abs(draw.number());
        const LocalProblem p = make(d, draw.delassus(d, d), draw.vector(d), {mu}, mu_roll);
        CHECK(siconos_error(p, one(p, target), target) < 1e-11);
      }
}

TEST_CASE("the error is 0 at a solution, that of the natural map elsewhere, and does not know its scale's unit") {
  const MatrixXd w = 4 * MatrixXd::Identity(3, 3);
  const LocalProblem p = make(3, w, Eigen::Vector3d(-2, 3, 4), {0.5});
  CHECK(siconos_error(p, {0.5, -0.15, -0.2}) < 1e-16);
  // At r = 0: u = q, |u_t| = 5, r - u^ = (2 - 2.5, -3, -4): outside the cone, projected to n = (-0.5 + 2.5) / 1.25.
  const double n = 1.6;
  CHECK(siconos_error(p, {0, 0, 0}) == Approx(n * std::sqrt(1.25) / std::sqrt(29.0)).epsilon(1e-14));
  const double n_ccp = (2 + 2.5) / 1.25;
  CHECK(siconos_error(p, {0, 0, 0}, Target::ccp) == Approx(n_ccp * std::sqrt(1.25) / std::sqrt(29.0)).epsilon(1e-14));
}

TEST_CASE("two contacts in the plane: every solver finds a solution that enumeration knows") {
  Draw draw(11);
  int sliding = 0, several = 0;
  for (int k = 0; k < 300; ++k) {
    const MatrixXd w = draw.delassus(4, 5);
    const VectorXd q = draw.vector(4);
    const std::vector<double> mu = {0.3 * std::abs(draw.number()), 0.6};
    const LocalProblem p = make(2, w, q, mu);
    for (const Target target : kTargets) {
      const auto known = enumerate(w, q, mu, target);
      REQUIRE(!known.empty());
      several += known.size() > 1;
      for (const LocalSolver solver : {local_solver("ppa"), local_solver("pdip")}) {
        const LocalSolution x = solve(p, {solver, target, 1e-12, 0});
        INFO("problem " << k << " target " << int(target) << " " << solver_name(solver) << " error " << x.error);
        CHECK(distance(known, x.r) < 1e-8 * (1 + Eigen::Map<const VectorXd>(x.r.data(), 4).norm()));
        for (int c = 0; c < 2; ++c)
          sliding += x.r[2 * c] > 0 && std::abs(x.r[2 * c + 1]) > (1 - 1e-9) * mu[c] * x.r[2 * c];
      }
    }
  }
  CHECK(sliding > 200);  // the cases are not all sticking
}

TEST_CASE("contacts that share fewer freedoms than they have rows are solved by every solver") {
  Draw draw(13);
  for (int k = 0; k < 20; ++k) {
    const int contacts = 6;
    const LocalProblem p =
        make(3, draw.delassus(3 * contacts, 9), draw.vector(3 * contacts), std::vector<double>(contacts, 0.4));
    for (const Target target : kTargets)
      for (const LocalSolver solver :
           {local_solver("nsgs"), local_solver("apgd"), local_solver("ppa"), local_solver("pdip")}) {
        const LocalSolution x = solve(p, {solver, target, 1e-9, 0});
        INFO("problem " << k << " solver " << solver_name(solver) << " target " << int(target));
        CHECK(x.error < (solver == local_solver("ppa") || solver == local_solver("pdip") ? 1e-9 : 1e-6));
        CHECK(siconos_error(p, x.r, target) == x.error);
      }
  }
}

TEST_CASE("problems that make no sense are refused by name and value") {
  const std::vector<Triplet> w = {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}};
  const auto make_with = [&](int d, const std::vector<Triplet>& entry, const std::vector<double>& q,
                             const std::vector<double>& mu) { return [=] { make_problem("p.dat", d, entry, q, mu); }; };
  refused(make_with(4, w, {0, 0, 0, 0}, {0.5}), "p.dat: spacedim = 4; 2, 3 or 5");
  refused(make_with(3, w, {0, 0}, {0.5}), "q has 2 values, 3 are needed");
  refused(make_with(3, w, {0, 0, 0}, {-0.5}), "mu[0] = -0.5");
  refused(make_with(3, w, {0, 0, 0}, {}), "mu is empty");
  refused(make_with(3, w, {0, NAN, 0}, {0.5}), "q[1] = nan");
  refused(make_with(3, {{0, 3, 1}}, {0, 0, 0}, {0.5}), "W(0, 3) lies outside the matrix of 3 rows");
  refused(make_with(3, {{0, 0, INFINITY}}, {0, 0, 0}, {0.5}), "W(0, 0) = inf");
  refused(make_with(3, {{1, 1, 1}, {2, 2, 1}}, {0, 0, 0}, {0.5}), "contact 0 has W_nn = 0");
  refused([] { local_solver("magic"); }, "\"magic\" is unknown; possible are nsgs, apgd, ppa, pdip, admm");
}
