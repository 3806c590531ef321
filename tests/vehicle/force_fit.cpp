// Forces fitted to data, against weighted least squares with Lagrange's multipliers, Dykstra's projections, and closed
// forms.
#include "vehicle/feasible/force_fit.h"

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/vehicles.h"
#include "tests/vehicle/on_slope.h"
#include "vehicle/model/statics.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Data = std::vector<MeasuredForce>;

/// Sums of forces, and of moments about the centre of mass, of four contacts' (normal, along, across) = right: those of
/// the whole vehicle as one rigid body.
struct Balance {
  MatrixXd matrix = MatrixXd::Zero(6, 12);
  VectorXd right = VectorXd::Zero(6);  // [N], [N m]

  Balance(const Vehicle& v, const Demand& d) {
    const auto wheels = stations(v);
    const Weights w = weigh(v);
    const Vector3d direction[3] = {Vector3d::UnitZ(), Vector3d::UnitX(), Vector3d::UnitY()};
    for (int i = 0; i < 4; ++i) {
      const Vec3d& c = wheels[std::size_t(i)].centre;
      const Vector3d arm(c.x - w.centre.x, c.y - w.centre.y, w.ground - w.centre.z);
      for (int k = 0; k < 3; ++k) matrix.col(3 * i + k) << direction[k], arm.cross(direction[k]);
    }
    right.head(3) = -w.total * Vector3d(d.gravity.x, d.gravity.y, d.gravity.z);
  }
};

/// Rows of the measured components over their deviations, and the data over theirs.
struct Weighed {
  MatrixXd matrix;
  VectorXd data;
  explicit Weighed(const Data& given) : matrix(MatrixXd::Zero(Eigen::Index(given.size()), 12)), data(given.size()) {
    for (std::size_t i = 0; i < given.size(); ++i) {
      const MeasuredForce& m = given[i];
      matrix(Eigen::Index(i), 3 * m.contact + m.component) = 1 / m.deviation;
      data(Eigen::Index(i)) = m.force / m.deviation;
    }
  }
};

VectorXd flat(const ForceFit& fit) {
  VectorXd x(3 * Eigen::Index(fit.contact.size()));
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x(i) = fit.contact[std::size_t(i / 3)].component[std::size_t(i % 3)].force;
  return x;
}

const FittedForce& component(const ForceFit& fit, int i) {
  return fit.contact[std::size_t(i / 3)].component[std::size_t(i % 3)];
}

Eigen::Index rank(const MatrixXd& m) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr(m);
  return qr.setThreshold(1e-10).rank();
}

MatrixXd under(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd m(a.rows() + b.rows(), a.cols());
  m << a, b;
  return m;
}

/// Nearest point of {|t| <= mu n}.
Vector3d onto_cone(const Vector3d& f, double mu) {
  const double t = f.tail(2).norm();
  if (t <= mu * f(0)) return f;
  if (mu * t <= -f(0)) return Vector3d::Zero();
  const double n = (f(0) + mu * t) / (1 + mu * mu);
  Vector3d g;
  g << n, f.tail(2) * (mu * n / t);
  return g;
}

/// Nearest point to u of {A u = b} and cones by Dykstra's alternating projections.
VectorXd dykstra(const MatrixXd& a, const VectorXd& b, const std::vector<double>& mu, const VectorXd& data) {
  const Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver(a);
  VectorXd x = data, rest = VectorXd::Zero(12);
  for (int i = 0; i < 200000; ++i) {
    const VectorXd plane = x - solver.solve(a * x - b);  // a plane needs no correction
    VectorXd next(12);
    for (int c = 0; c < 4; ++c)
      next.segment<3>(3 * c) = onto_cone(plane.segment<3>(3 * c) + rest.segment<3>(3 * c), mu[std::size_t(c)]);
    rest += plane - next;
    const double moved = (next - x).cwiseAbs().maxCoeff();
    x = next;
    if (moved < 1e-13 * data.cwiseAbs().maxCoeff()) break;
  }
  return x;
}

}  // namespace

TEST_CASE("forces fitted where no cone binds are weighted least squares under balance, with their errors") {
  const Vehicle v = shipped_vehicle("hmmwv");
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto loads = static_loads(v);
  int undetermined = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const double along = 5 * uniform(random), across = 5 * uniform(random);
    const Demand d = on_slope(along, across, 50, false);
    const Balance balance(v, d);
    Data data;
    for (int i = 0; i < 12; ++i)
      if (trial % 3 == 0 || uniform(random) > -0.4)
        data.push_back({.contact = i / 3,
                        .component = i % 3,
                        .force = (i % 3 == 0 ? loads[std::size_t(i / 3)] : 0) + 100 * normal(random),
                        .deviation = 20 * std::exp(uniform(random))});
    const ForceFit fit = fit_forces(v, d, data, {true, false});
    REQUIRE(fit.admissible);
    const Weighed w(data);
    // Lagrange's equations: D^T W^2 D x + A^T y = D^T W^2 data, A x = b, lengths and forces scaled to one size.
    MatrixXd kkt = MatrixXd::Zero(18, 18);
    const double scale = 1e-3;
    kkt << w.matrix.transpose() * w.matrix, scale * balance.matrix.transpose(), scale * balance.matrix,
        MatrixXd::Zero(6, 6);
    VectorXd right(18);
    right << w.matrix.transpose() * w.data, scale * balance.right;
    Eigen::JacobiSVD<MatrixXd> svd(kkt, Eigen::ComputeFullU | Eigen::ComputeFullV);
    svd.setThreshold(1e-12);
    const VectorXd x = svd.solve(right).head(12);
    const double chi_square = (w.matrix * x - w.data).squaredNorm();
    CHECK(fit.chi_square == Approx(chi_square).epsilon(1e-6).margin(1e-6));
    CHECK((balance.matrix * flat(fit) - balance.right).cwiseAbs().maxCoeff() < 1e-4);
    const MatrixXd selected = 20 * w.matrix, all = under(balance.matrix, selected);
    CHECK(fit.degrees == Eigen::Index(data.size()) - (rank(all) - rank(balance.matrix)));
    const MatrixXd free = balance.matrix.fullPivLu().kernel();
    const MatrixXd information = free.transpose() * w.matrix.transpose() * w.matrix * free;
    const MatrixXd covariance = free * information.completeOrthogonalDecomposition().pseudoInverse() * free.transpose();
    for (int i = 0; i < 12; ++i) {
      INFO("trial " << trial << " component " << i);
      const bool determined = rank(under(all, VectorXd::Unit(12, i).transpose())) == rank(all);
      CHECK(component(fit, i).determined == determined);
      if (!determined) {
        ++undetermined;
        continue;
      }
      CHECK(component(fit, i).force == Approx(x(i)).margin(1e-2));
      const double error = std::sqrt(covariance(i, i));
      CHECK(component(fit, i).high - component(fit, i).force == Approx(error).epsilon(1e-3).margin(1e-2));
      CHECK(component(fit, i).force - component(fit, i).low == Approx(error).epsilon(1e-3).margin(1e-2));
    }
  }
  CHECK(undetermined > 0);
}

TEST_CASE("forces fitted where cones bind are the nearest by Dykstra's projections") {
  const Vehicle v = shipped_vehicle("hmmwv");
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  int bound = 0;
  for (int trial = 0; trial < 10; ++trial) {
    const double along = 10 * uniform(random), across = 6 * uniform(random);
    const Demand d = on_slope(along, across, 0.3, false);
    const Balance balance(v, d);
    // Contact by contact one deviation along and across, so that the weighed cone is round.
    VectorXd deviation(12), data(12);
    std::vector<double> mu;
    Data given;
    for (int c = 0; c < 4; ++c) {
      const double of_normal = 40 * std::exp(uniform(random)), of_tangent = 40 * std::exp(uniform(random));
      mu.push_back(d.friction * of_normal / of_tangent);
      for (int k = 0; k < 3; ++k) {
        const int i = 3 * c + k;
        deviation(i) = k == 0 ? of_normal : of_tangent;
        const double force = (k == 0 ? 6000 : 0) + 1500 * normal(random);
        given.push_back({.contact = c, .component = k, .force = force, .deviation = deviation(i)});
        data(i) = force / deviation(i);
      }
    }
    const VectorXd expected = dykstra(balance.matrix * deviation.asDiagonal(), balance.right, mu, data);
    const ForceFit fit = fit_forces(v, d, given, {true, false});
    REQUIRE(fit.admissible);
    INFO("trial " << trial);
    // In deviations. What the cone program leaves of t, 1e-8 of the mean load, moves the forces by about its root.
    for (int i = 0; i < 12; ++i) CHECK(component(fit, i).force / deviation(i) == Approx(expected(i)).margin(0.02));
    CHECK(fit.chi_square == Approx((expected - data).squaredNorm()).epsilon(1e-5));
    for (const FittedContact& c : fit.contact) {
      CHECK(c.friction_used < 1 + 1e-4);
      bound += c.friction_used > 0.9999;
    }
  }
  CHECK(bound >= 10);
}

TEST_CASE("data that are admissible come back, and what they leave open is inside its range") {
  const Vehicle v = shipped_vehicle("hmmwv");
  for (const bool moving : {false, true}) {
    const Demand d = on_slope(12, 3, 0.6, moving);
    const Feasibility known = feasible(v, d);
    REQUIRE(known.feasible);
    VectorXd truth(12);
    for (int c = 0; c < 4; ++c)
      truth.segment<3>(3 * c) << known.contact[std::size_t(c)].normal, known.contact[std::size_t(c)].along,
          known.contact[std::size_t(c)].across;
    for (const int every : {1, 2, 5}) {
      Data data;
      for (int i = 0; i < 12; i += every)
        data.push_back({.contact = i / 3, .component = i % 3, .force = truth(i), .deviation = 10});
      const ForceFit fit = fit_forces(v, d, data);
      REQUIRE(fit.admissible);
      CHECK(fit.chi_square < 1e-10);
      for (int i = 0; i < 12; ++i) {
        INFO("every " << every << " component " << i);
        const FittedForce& f = component(fit, i);
        CHECK(f.low < truth(i));
        CHECK(f.high > truth(i));
        CHECK(f.measured.has_value() == (i % every == 0));
        if (f.measured || f.determined) CHECK(f.force == Approx(truth(i)).margin(1e-3));
        if (f.measured) CHECK(f.residual == Approx(0).margin(1e-4));
      }
      if (every == 1) CHECK(fit.degrees == (moving ? 7 : 6));  // an open centre differential equates two torques
    }
  }
}

TEST_CASE("a differential shares the fitted forces of two tracks out equally") {
  const Vehicle v = shipped_vehicle("m113");
  const auto wheels = stations(v);
  const Demand d = on_slope(10, 0, 0.8);
  const double half = weigh(v).total * kGravity * std::sin(10 * kDegree) / 2;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Data data;
  double left = 0, right = 0;
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const double force = 2 * half / double(wheels.size()) * (1 + 0.3 * wheels[i].side + 0.1 * uniform(random));
    data.push_back({.contact = int(i), .component = 1, .force = force, .deviation = 50});
    (wheels[i].side > 0 ? left : right) += force;
  }
  const ForceFit fit = fit_forces(v, d, data);
  REQUIRE(fit.admissible);
  const double a_side = double(wheels.size()) / 2;
  for (const MeasuredForce& m : data) {
    const bool is_left = wheels[std::size_t(m.contact)].side > 0;
    const double expected = m.force + (half - (is_left ? left : right)) / a_side;
    CHECK(fit.contact[std::size_t(m.contact)].component[1].force == Approx(expected).margin(0.05));
  }
  CHECK(fit.torque[0] == Approx(fit.torque[1]).epsilon(1e-6));
  CHECK(fit.degrees == 2);
}

TEST_CASE("the range of a force that only its cone limits ends at the cone") {
  const Vehicle v = shipped_vehicle("hmmwv");
  const Demand d = on_slope(0, 0, 0.5, false);
  const auto loads = static_loads(v);
  REQUIRE(loads[2] < loads[0]);  // the front left wheel can balance what the rear left one does
  Data data;
  for (int c = 0; c < 3; ++c)
    data.push_back({.contact = c, .component = 0, .force = loads[std::size_t(c)], .deviation = 0.01});
  const ForceFit fit = fit_forces(v, d, data, {true, false});
  REQUIRE(fit.admissible);
  const FittedForce& along = fit.contact[2].component[1];
  CHECK(!along.determined);
  CHECK(along.high == Approx(0.5 * loads[2]).margin(0.1));
  CHECK(along.low == Approx(-0.5 * loads[2]).margin(0.1));
  const FittedForce& fourth = fit.contact[3].component[0];
  CHECK(fourth.determined);  // by the other three and balance
  CHECK(fourth.force == Approx(loads[3]).margin(0.1));
}

TEST_CASE("no forces are fitted where none are admissible, and questions without an answer are refused") {
  const Vehicle v = shipped_vehicle("hmmwv");
  const Data data{{.contact = 0, .component = 0, .force = 6000, .deviation = 50}};
  const ForceFit none = fit_forces(v, on_slope(40, 0, 0.6), data);
  CHECK(!none.admissible);
  CHECK(none.contact.empty());
  // At the slope's limit the admissible forces have no interior; cones with a room of 1e-6 give an answer.
  const ForceFit last = fit_forces(v, on_slope(std::atan(0.6) / kDegree - 1e-6, 0, 0.6, false), data, {true, false});
  REQUIRE(last.admissible);
  for (const FittedContact& c : last.contact) CHECK(c.friction_used == Approx(1).margin(1e-3));
  Demand d = on_slope(0, 0, 0.6);
  refused([&] { fit_forces(v, d, {}); }, "no force");
  d.edge_distance = 0.1;
  refused([&] { fit_forces(v, d, data); }, "edge");
  d.edge_distance = 0;
  d.step = 0.1;
  refused([&] { fit_forces(v, d, data); }, "step");
}
