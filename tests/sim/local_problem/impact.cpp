// Sequential impacts against closed forms: chains of balls, a sphere that grazes, a rod, a box at rest.
#include "sim/local_problem/impact.h"

#include <Eigen/Dense>

#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::sim;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Bodies with inverse masses `inverse`, contacts u = H^T v.
struct Scene {
  VectorXd inverse, v;
  MatrixXd h;

  LocalProblem problem(int dimension, double mu) const {
    const MatrixXd w = h.transpose() * inverse.asDiagonal() * h;
    const VectorXd q = h.transpose() * v;
    std::vector<Triplet> entry;
    for (Index i = 0; i < w.rows(); ++i)
      for (Index j = 0; j < w.cols(); ++j) entry.push_back({i, j, w(i, j)});
    return make_problem("scene", dimension, entry, {q.begin(), q.end()},
                        std::vector<double>(std::size_t(w.rows() / dimension), mu));
  }
  VectorXd after(const ImpactResult& result) const {
    return v + inverse.asDiagonal() * (h * Eigen::Map<const VectorXd>(result.r.data(), h.cols()));
  }
  double energy(const VectorXd& speed) const {
    double sum = 0;
    for (Index i = 0; i < speed.size(); ++i) sum += speed[i] * speed[i] / inverse[i] / 2;
    return sum;
  }
};

/// Balls in a row that touch; the normal of contact i pushes ball i back and ball i + 1 on. Tangents: nothing moves.
Scene cradle(const VectorXd& mass, double speed) {
  const Index n = Index(mass.size());
  Scene scene{mass.cwiseInverse(), VectorXd::Zero(n), MatrixXd::Zero(n, 2 * (n - 1))};
  scene.v[0] = speed;
  for (Index i = 0; i + 1 < n; ++i) {
    scene.h(i, 2 * i) = -1;
    scene.h(i + 1, 2 * i) = 1;
  }
  return scene;
}

/// A sphere of mass 1 and radius r in the plane (x, z, omega) on ground: u = (v_z, v_x + r omega).
Scene sphere(double v_x, double v_z, double radius) {
  Scene scene{VectorXd(3), VectorXd(3), MatrixXd::Zero(3, 2)};
  scene.inverse << 1, 1, 2.5 / (radius * radius);
  scene.v << v_x, v_z, 0;
  scene.h(1, 0) = 1;
  scene.h(0, 1) = 1;
  scene.h(2, 1) = radius;
  return scene;
}

}  // namespace

TEST_CASE("a chain of equal balls passes the first one's speed to the last, in as many strikes as contacts") {
  for (const ImpactLaw law : {ImpactLaw::newton, ImpactLaw::poisson})
    for (const int n : {2, 3, 5, 20}) {
      const Scene scene = cradle(VectorXd::Ones(n), 3);
      const ImpactResult result = sequential_impacts(scene.problem(2, 0), {.law = law, .restitution = 1});
      const VectorXd v = scene.after(result);
      CHECK(result.ended);
      CHECK(result.strikes == n - 1);
      CHECK(v.head(n - 1).norm() < 1e-13);
      CHECK(v[n - 1] == Approx(3));
      CHECK(std::abs(result.energy_gain) < 1e-12);
    }
}

TEST_CASE("a chain of unequal balls: the product of two-ball laws, momentum, and the energy that e takes") {
  const VectorXd mass = (VectorXd(3) << 4, 2, 1).finished();  // lighter and lighter: each is struck once
  for (const double e : {1.0, 0.6}) {
    const Scene scene = cradle(mass, 1);
    const ImpactResult result = sequential_impacts(scene.problem(2, 0), {.restitution = e});
    const VectorXd v = scene.after(result);
    const double first = (1 + e) * 4 / 6, second = first * (1 + e) * 2 / 3;
    CHECK(v[2] == Approx(second).epsilon(1e-12));
    CHECK(mass.dot(v) == Approx(4).epsilon(1e-13));
    CHECK(scene.energy(v) - scene.energy(scene.v) == Approx(result.energy_gain).margin(1e-13));
    CHECK((e < 1 ? result.energy_gain < -0.1 : std::abs(result.energy_gain) < 1e-13));
  }
}

TEST_CASE("a sphere strikes the ground aslant: gross slip and rolling as in closed form, by both laws") {
  const double mu = 0.2, e = 0.7, radius = 0.1;
  for (const ImpactLaw law : {ImpactLaw::newton, ImpactLaw::poisson})
    for (const double v_x : {0.1, 0.5, 1.0, 3.0}) {
      const Scene scene = sphere(v_x, -1, radius);
      const ImpactResult result = sequential_impacts(scene.problem(2, mu), {.law = law, .restitution = e});
      const VectorXd v = scene.after(result);
      INFO("v_x " << v_x << " law " << int(law));
      CHECK(result.strikes == 1);
      CHECK(v[1] == Approx(e).epsilon(1e-12));
      const bool slides = v_x > 3.5 * mu * (1 + e);
      CHECK(v[0] == Approx(slides ? v_x - mu * (1 + e) : v_x * 5 / 7).epsilon(1e-12));
      CHECK(v[2] == Approx(slides ? -2.5 * mu * (1 + e) / radius : -v_x * 5 / 7 / radius).epsilon(1e-12));
    }
}

TEST_CASE(
    "a slanted rod that slides one way: Poisson's law as integrated over the impulse, Newton's by its definition") {
  // Rod of mass 1 and length 2 at 60 degrees, its end on the ground. u = (v_z + c omega, v_x - s omega).
  const double c = 0.5, s = std::sqrt(0.75), mu = 0.3, e = 0.5;
  Scene rod{VectorXd(3), VectorXd(3), MatrixXd::Zero(3, 2)};
  rod.inverse << 1, 1, 3;
  rod.v << 2, -1, 0;
  rod.h << 0, 1, 1, 0, c, -s;
  const LocalProblem p = rod.problem(2, mu);
  const VectorXd newton = rod.after(sequential_impacts(p, {.law = ImpactLaw::newton, .restitution = e}));
  CHECK((rod.h.transpose() * newton)[0] == Approx(e));
  // Routh's method: dr_t = -mu dr_n while it slides; compression until u_n = 0, then e times that impulse more.
  const MatrixXd w = rod.h.transpose() * rod.inverse.asDiagonal() * rod.h;
  Eigen::Vector2d u = rod.h.transpose() * rod.v;
  const double rate = w(0, 0) - mu * w(0, 1), normal = (1 + e) * -u[0] / rate;
  u += w * Eigen::Vector2d(normal, -mu * normal);
  REQUIRE(u[1] > 0);  // it slides to the end
  const ImpactResult result = sequential_impacts(p, {.law = ImpactLaw::poisson, .restitution = e});
  CHECK(result.r[0] == Approx(normal).epsilon(1e-12));
  CHECK(result.r[1] == Approx(-mu * normal).epsilon(1e-12));
  CHECK(result.energy_gain < 0);
}

TEST_CASE("a box at rest on two contacts is held by micro-impulses that sum to its weight") {
  // Box of width 2 and mass 3 at (z, omega), gravity for 1 ms; contacts at its corners.
  Scene box{VectorXd(2), VectorXd(2), MatrixXd::Zero(2, 4)};
  box.inverse << 1.0 / 3, 0.8;
  box.v << -9.81e-3, 0;
  box.h << 1, 0, 1, 0, 1, 0, -1, 0;
  const LocalProblem p = box.problem(2, 0);
  const ImpactSettings settings{.restitution = 0.8, .resting_speed = 0.02, .tolerance = 1e-10};
  const ImpactResult rest = sequential_impacts(p, settings);
  CHECK(rest.ended);
  CHECK(rest.strikes > 2);
  CHECK(rest.r[0] + rest.r[2] == Approx(3 * 9.81e-3).epsilon(1e-6));
  CHECK(box.after(rest).norm() < 1e-8);
  Scene dropped = box;
  dropped.v[0] = -1;  // faster than a contact at rest: it rebounds
  CHECK(dropped.after(sequential_impacts(dropped.problem(2, 0), settings))[0] > 0.3);
}

TEST_CASE("impacts refuse restitution out of range and rolling friction") {
  const LocalProblem p = cradle(VectorXd::Ones(2), 1).problem(2, 0);
  refused([&] { sequential_impacts(p, {.restitution = 1.5}); }, "restitution = 1.5; a number from 0 to 1");
  std::vector<Triplet> w;
  for (Index i = 0; i < 5; ++i) w.push_back({i, i, 1});
  const LocalProblem rolling = make_problem("rolls", 5, w, std::vector<double>(5, -1), {0.5}, {0.1});
  refused([&] { sequential_impacts(rolling, {}); }, "rolls: impacts with rolling friction");
}
