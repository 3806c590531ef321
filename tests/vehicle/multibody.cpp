// Reduced-coordinate dynamics: the algorithms against each other on random trees, and against closed forms.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "vehicle/multibody/dynamics.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle::multibody;

namespace {

const Vector3 kDown(0, 0, -kGravity);

struct Draw {
  std::mt19937 engine;
  double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(engine); }
  Vector3 vector() { return {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)}; }
  VectorX vector(int n) {
    VectorX v(n);
    for (int i = 0; i < n; ++i) v(i) = (*this)(-1, 1);
    return v;
  }
  Matrix3 rotation() { return Eigen::AngleAxisd((*this)(-3, 3), vector().normalized()).toRotationMatrix(); }
  Matrix6 inertia() {
    const Matrix3 a = rotation();
    const Vector3 m((*this)(0.5, 1), (*this)(0.5, 1), (*this)(0.6, 0.9));
    return spatial_inertia((*this)(0.5, 3), 0.3 * vector(), a * m.asDiagonal() * a.transpose());
  }
};

/// `shape` 0: chain, 1: star, 2: anything.
Tree random_tree(Draw& draw, int bodies, int shape, bool floating) {
  Tree tree;
  for (int i = 0; i < bodies; ++i) {
    TreeBody b;
    b.parent = i == 0 ? -1 : shape == 0 ? i - 1 : shape == 1 ? 0 : draw.below(i);
    b.type = i == 0 && floating ? JointType::floating : JointType(1 + draw.below(3));
    b.axis = draw.vector().normalized();
    b.from_parent = {draw.rotation(), draw.vector()};
    b.inertia = draw.inertia();
    tree.add(b);
  }
  return tree;
}

struct Case {
  Tree tree;
  VectorX q, v, tau;
  std::vector<Vector6> external;
};

Case random_case(Draw& draw, int bodies, int shape, bool floating) {
  Case c{random_tree(draw, bodies, shape, floating), {}, {}, {}, {}};
  c.q = moved(c.tree, c.tree.zero_position(), draw.vector(c.tree.velocity_count()), 1);
  c.v = draw.vector(c.tree.velocity_count());
  c.tau = 5 * draw.vector(c.tree.velocity_count());
  for (int i = 0; i < bodies; ++i) c.external.push_back(3 * draw.vector(6));
  return c;
}

double relative(const MatrixX& a, const MatrixX& b) { return (a - b).norm() / (1 + b.norm()); }

/// One classical Runge-Kutta step of (q, v), for trees without quaternions.
template <class Acceleration>
void runge_kutta(const Acceleration& acceleration, VectorX& q, VectorX& v, double h) {
  const VectorX k1 = acceleration(q, v), q2 = q + 0.5 * h * v, v2 = v + 0.5 * h * k1;
  const VectorX k2 = acceleration(q2, v2), q3 = q + 0.5 * h * v2, v3 = v + 0.5 * h * k2;
  const VectorX k3 = acceleration(q3, v3), q4 = q + h * v3, v4 = v + h * k3;
  const VectorX k4 = acceleration(q4, v4);
  q += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
  v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
}

/// Rod of `mass` and `length` that hangs from its end and swings about y.
TreeBody rod(int parent, const Vector3& at, double mass, double length) {
  TreeBody b;
  b.parent = parent;
  b.axis = Vector3::UnitY();
  b.from_parent.r = at;
  const double moment = mass * length * length / 12;
  b.inertia = spatial_inertia(mass, {0, 0, -length / 2}, Vector3(moment, moment, 1e-3 * moment).asDiagonal());
  return b;
}

}  // namespace

TEST_CASE("five ways to the accelerations of random trees agree") {
  Draw draw{std::mt19937(11)};
  double mass = 0, articulated = 0, divided = 0, assembled = 0, inverse = 0;
  for (int trial = 0; trial < 90; ++trial) {
    const Case c = random_case(draw, 1 + draw.below(18), trial % 3, trial % 2 == 0);
    const int n = c.tree.velocity_count();
    const MatrixX m = mass_matrix_by_composites(c.tree, c.q);
    mass = std::max(mass, relative(mass_matrix_by_unit_vectors(c.tree, c.q), m));
    const VectorX bias = inverse_dynamics(c.tree, c.q, c.v, VectorX::Zero(n), kDown, c.external);
    const VectorX direct = m.llt().solve(c.tau - bias);
    articulated = std::max(articulated,
                           relative(forward_by_articulated_bodies(c.tree, c.q, c.v, c.tau, kDown, c.external), direct));
    const VectorX conquered = forward_by_divide_and_conquer(c.tree, c.q, c.v, c.tau, kDown, c.external);
    divided = std::max(divided, relative(conquered, direct));
    std::vector<int> order(std::size_t(c.tree.body_count()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), draw.engine);
    for (const std::vector<int>& by : {std::vector<int>{}, order})
      assembled =
          std::max(assembled, relative(forward_by_assembly(c.tree, c.q, c.v, c.tau, kDown, c.external, by), direct));
    inverse = std::max(inverse, relative(inverse_dynamics(c.tree, c.q, c.v, conquered, kDown, c.external), c.tau));
  }
  CHECK(agrees("mass matrix by unit vectors", 0, mass, 1e-12));
  CHECK(agrees("articulated bodies", 0, articulated, 1e-10));
  CHECK(agrees("divide and conquer", 0, divided, 1e-10));
  CHECK(agrees("assembly and disassembly in any order", 0, assembled, 1e-10));
  CHECK(agrees("inverse of forward dynamics", 0, inverse, 1e-10));
}

TEST_CASE("two trees on the ground are assembled like one, and an order without a joint is refused") {
  Draw draw{std::mt19937(14)};
  Tree tree;
  for (const int parent : {-1, 0, -1, 2}) {
    TreeBody b;
    b.parent = parent;
    b.axis = draw.vector().normalized();
    b.from_parent = {draw.rotation(), draw.vector()};
    b.inertia = draw.inertia();
    tree.add(b);
  }
  const VectorX q = draw.vector(4), v = draw.vector(4), tau = draw.vector(4);
  const VectorX direct =
      mass_matrix_by_composites(tree, q).llt().solve(tau - inverse_dynamics(tree, q, v, VectorX::Zero(4), kDown));
  for (const std::vector<int>& order : {std::vector<int>{2, 0, 3, 1}, {0, 1, 2, 3}, {3, 1, 2, 0}})
    CHECK(relative(forward_by_assembly(tree, q, v, tau, kDown, {}, order), direct) < 1e-11);
  refused([&] { forward_by_assembly(tree, q, v, tau, kDown, {}, {0, 1, 2}); }, "each of the 4 joints once");
  refused([&] { forward_by_assembly(tree, q, v, tau, kDown, {}, {0, 1, 2, 2}); }, "each of the 4 joints once");
}

TEST_CASE("velocities and accelerations of points are the differences of their places") {
  Draw draw{std::mt19937(12)};
  double jacobian = 0, velocity = 0, bias = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Case c = random_case(draw, 6, 2, true);
    const int body = draw.below(6);
    const Vector3 point = draw.vector();
    const auto place = [&](double t) {
      return point_position(kinematics(c.tree, moved(c.tree, c.q, c.v, t), c.v), body, point);
    };
    const Kinematics k = kinematics(c.tree, c.q, c.v);
    const double h = 1e-4;
    velocity = std::max(velocity, (point_velocity(k, body, point) - (place(h) - place(-h)) / (2 * h)).norm());
    jacobian =
        std::max(jacobian, (point_jacobian(c.tree, k, body, point) * c.v - point_velocity(k, body, point)).norm());
    // At constant v the floating body's origin moves straight in `moved`, but v is in the turning body's frame.
    const auto speed = [&](double t) {
      return point_velocity(kinematics(c.tree, moved(c.tree, c.q, c.v, t), c.v), body, point);
    };
    bias = std::max(bias, (point_bias(c.tree, k, c.v, body, point) - (speed(h) - speed(-h)) / (2 * h)).norm());
  }
  CHECK(agrees("velocity [m/s]", 0, velocity, 1e-6));
  CHECK(agrees("J v [m/s]", 0, jacobian, 1e-12));
  CHECK(agrees("acceleration [m/s^2]", 0, bias, 1e-5));
}

TEST_CASE("a free body's forces change its momentum, whatever hangs on it") {
  Draw draw{std::mt19937(13)};
  for (int trial = 0; trial < 10; ++trial) {
    Case c = random_case(draw, 7, 2, true);
    c.tau.head<6>().setZero();
    const VectorX dv = forward_by_articulated_bodies(c.tree, c.q, c.v, c.tau, kDown);
    // Sum of mass times acceleration of the centres of mass.
    const Kinematics k = kinematics(c.tree, c.q, c.v);
    Vector3 rate = Vector3::Zero();
    double mass = 0;
    for (int i = 0; i < 7; ++i) {
      const Matrix6& inertia = c.tree.body(i).inertia;
      const Vector3 centre = Vector3(inertia(2, 4), inertia(0, 5), inertia(1, 3)) / inertia(3, 3);
      mass += inertia(3, 3);
      rate += inertia(3, 3) * (point_jacobian(c.tree, k, i, centre) * dv + point_bias(c.tree, k, c.v, i, centre));
    }
    CHECK((rate - mass * kDown).norm() < 1e-10 * mass);
  }
}

TEST_CASE("a compound pendulum swings with its closed-form period") {
  Tree tree;
  const double length = 0.8, amplitude = 1;
  tree.add(rod(-1, Vector3::Zero(), 2, length));
  const auto acceleration = [&](const VectorX& q, const VectorX& v) {
    return forward_by_divide_and_conquer(tree, q, v, VectorX::Zero(1), kDown);
  };
  VectorX q = VectorX::Constant(1, amplitude), v = VectorX::Zero(1);
  const double h = 1e-4;
  double time = 0;
  while (q(0) > 0) {
    runge_kutta(acceleration, q, v, h);
    time += h;
  }
  time -= q(0) / v(0);
  // Quarter period K(sin(a / 2)) / w with w^2 = 3 g / (2 L).
  const double expected = std::comp_ellint_1(std::sin(amplitude / 2)) / std::sqrt(1.5 * kGravity / length);
  CHECK(agrees("quarter period [s]", expected, time, 1e-8));
}

TEST_CASE("a double pendulum over the top keeps its energy") {
  Tree tree;
  tree.add(rod(-1, Vector3::Zero(), 2, 0.8));
  tree.add(rod(0, {0, 0, -0.8}, 1, 0.6));
  const auto energy = [&](const VectorX& q, const VectorX& v) {
    const Kinematics k = kinematics(tree, q, v);
    return kinetic_energy(tree, k) + potential_energy(tree, k, kDown);
  };
  const auto acceleration = [&](const VectorX& q, const VectorX& v) {
    return forward_by_articulated_bodies(tree, q, v, VectorX::Zero(2), kDown);
  };
  VectorX q(2), v = VectorX::Zero(2);
  q << 3, 0.5;
  const double before = energy(q, v);
  double largest = 0;
  for (int step = 0; step < 20000; ++step) {
    runge_kutta(acceleration, q, v, 2.5e-4);
    largest = std::max(largest, kinetic_energy(tree, kinematics(tree, q, v)));
  }
  CHECK(agrees("energy lost in 5 s over the largest kinetic energy", 0, (energy(q, v) - before) / largest, 1e-8));
}

TEST_CASE("a four-bar with a loop moves as one pendulum does") {
  // Two equal rods carry a coupler that stays level: the parallelogram has one degree of freedom and
  // (2 m L^2 / 3 + M L^2) a'' = -(m + M) g L sin a.
  const double rod_mass = 1, coupler = 3, length = 0.7, wide = 0.4;
  Tree tree;
  tree.add(rod(-1, Vector3::Zero(), rod_mass, length));
  tree.add(rod(-1, {wide, 0, 0}, rod_mass, length));
  TreeBody bar;
  bar.parent = 0;
  bar.axis = Vector3::UnitY();
  bar.from_parent.r = {0, 0, -length};
  bar.inertia = spatial_inertia(coupler, {wide / 2, 0, 0}, Vector3(0.01, 0.05, 0.05).asDiagonal());
  tree.add(bar);
  const std::vector<Loop> loops{{1, 2, {0, 0, -length}, {wide, 0, 0}, 0}};
  const double angle = 0.6, speed = 1.3;
  VectorX q(3), v(3);
  q << angle, angle, -angle;
  v << speed, speed, -speed;
  const LoopMotion m = forward_with_loops(tree, loops, q, v, VectorX::Zero(3), kDown);
  const double expected = -(rod_mass + coupler) * kGravity * length * std::sin(angle) /
                          (2 * rod_mass * length * length / 3 + coupler * length * length);
  CHECK(agrees("acceleration [rad/s^2]", expected, m.acceleration(0), 1e-10));
  CHECK(agrees("the other rod [rad/s^2]", expected, m.acceleration(1), 1e-10));
  CHECK(agrees("the coupler [rad/s^2]", -expected, m.acceleration(2), 1e-10));
  VectorX open(3);
  open << angle, angle + 0.1, -angle + 0.05;
  CHECK(close_loops(tree, loops, open, {0}) < 1e-12);
  CHECK(agrees("the rod that was held [rad]", angle, open(0), 0));
  CHECK(agrees("the other follows [rad]", angle, open(1), 1e-10));
}

TEST_CASE("trees that cannot be are refused") {
  Tree tree;
  TreeBody b;
  b.parent = 0;
  refused([&] { tree.add(b); }, "parent");
  b.parent = -1;
  b.inertia = spatial_inertia(0, Vector3::Zero(), Matrix3::Identity());
  refused([&] { tree.add(b); }, "must be positive");
}
