// The reduced-coordinate HMMWV with all its wishbones against the same bodies and joints in the contact engine.
#include <cmath>
#include <random>

#include "base/units.h"
#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/joint_error.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"
#include "tests/support/vehicles.h"
#include "vehicle/model/statics.h"
#include "vehicle/multibody/vehicle_tree.h"
#include "vehicle/world/engine_bodies.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;
using namespace gonogo::vehicle::multibody;

namespace {

const Vector3 kDown(0, 0, -kGravity);

Matrix3 rotation(const Quat& q) { return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix(); }

/// External forces on the bodies from springs and dampers, in the bodies' frames.
std::vector<Vector6> strut_forces(const VehicleTree& v, const std::vector<Strut>& struts, const Kinematics& k) {
  std::vector<Vector6> force(std::size_t(v.tree.body_count()), Vector6::Zero());
  for (const Strut& s : struts) {
    const Vector3 parent_point = v.local(s.parent, s.parent_point), child_point = v.local(s.child, s.child_point);
    const Vector3 apart = point_position(k, s.child, child_point) - point_position(k, s.parent, parent_point);
    const double length = apart.norm();
    const Vector3 along = apart / length;
    double push = s.spring ? s.spring->push(length) : 0;
    if (s.damper && !s.damper->force.empty()) {
      const double speed =
          along.dot(point_velocity(k, s.child, child_point) - point_velocity(k, s.parent, parent_point));
      const bool bump = !s.damper->bump.empty() && (length < s.damper->shortest || length > s.damper->longest);
      push += (bump ? s.damper->bump : s.damper->force)(speed);
    }
    force[std::size_t(s.child)] += force_at(child_point, k.from_world[s.child].E * (push * along));
    force[std::size_t(s.parent)] -= force_at(parent_point, k.from_world[s.parent].E * (push * along));
  }
  return force;
}

/// Positions of the tree from the poses of the engine's bodies, whose frames were turned to principal axes by `start`.
VectorX tree_position(const VehicleTree& v, const std::vector<Vector3>& centre,
                      const std::vector<sim::BodyState>& start, const std::vector<sim::BodyState>& now) {
  VectorX q = v.tree.zero_position();
  std::vector<Matrix3> turn;
  for (int i = 0; i < v.tree.body_count(); ++i) {
    const TreeBody& b = v.tree.body(i);
    turn.push_back(rotation(now[i].orientation) * rotation(start[i].orientation).transpose());
    const Matrix3 relative = b.parent >= 0 ? Matrix3(turn[b.parent].transpose() * turn[i]) : turn[i];
    const Eigen::Quaterniond as(relative);
    if (b.type == JointType::revolute) {
      const Eigen::AngleAxisd about(relative);
      q(b.first_position) = about.angle() * (about.axis().dot(b.axis) > 0 ? 1 : -1);
    } else {
      q.segment<4>(b.first_position) << as.w(), as.x(), as.y(), as.z();
    }
    if (b.type == JointType::floating)
      q.segment<3>(b.first_position + 4) = multibody::vector(now[i].position) - turn[i] * centre[i];
  }
  return q;
}

struct Model {
  Vehicle vehicle;
  Assembly assembly;
  VehicleTree reduced;
  std::vector<Vector3> centre;  // of mass, in the bodies' frames

  explicit Model(const std::string& name)
      : vehicle(shipped_vehicle(name)), assembly(assemble(vehicle)), reduced(vehicle_tree(assembly)) {
    for (std::size_t i = 0; i < assembly.body.size(); ++i)
      centre.push_back(reduced.local(int(i), assembly.body[i].centre));
  }
};

/// Joint velocities that tumble the vehicle and move its suspension, with all loops closed.
VectorX thrown(const Model& m) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  VectorX v(m.reduced.tree.velocity_count());
  for (int i = 0; i < v.size(); ++i) v(i) = 0.5 * u(random);
  for (const int axle : m.reduced.axle) v(axle) = 5;
  const VectorX q = m.reduced.tree.zero_position();
  const LoopEquations e = loop_equations(m.reduced.tree, m.reduced.loop, kinematics(m.reduced.tree, q, v), v);
  return v - e.jacobian.completeOrthogonalDecomposition().solve(e.jacobian * v);
}

/// Midpoint rule, loops stabilised.
void step(const Model& m, VectorX& q, VectorX& v, double h) {
  const Tree& tree = m.reduced.tree;
  const auto acceleration = [&](const VectorX& at, const VectorX& with) {
    const VectorX none = VectorX::Zero(tree.velocity_count());
    return forward_with_loops(tree, m.reduced.loop, at, with, none, kDown, {}, 50).acceleration;
  };
  const VectorX k1 = acceleration(q, v);
  const VectorX middle = v + 0.5 * h * k1;
  const VectorX k2 = acceleration(moved(tree, q, v, 0.5 * h), middle);
  q = moved(tree, q, v + 0.5 * h * k2, h);
  v += h * k2;
}

struct Flight {
  double place = 0, turn = 0;  // largest differences of bodies [m, rad]
  double drift = 0;            // of the engine's joints [m]
};

/// Throws the vehicle in both models for a time.
Flight fly(sim::Backend backend, const Model& m, double seconds, double engine_step) {
  sim::SceneWorld w;
  w.origin = {-10, -10, -10};
  w.size = {20, 20, 20};
  const EngineBodies bodies = add_bodies(w, m.assembly, {});
  VectorX q = m.reduced.tree.zero_position(), v = thrown(m);
  const Kinematics k = kinematics(m.reduced.tree, q, v);
  for (std::size_t i = 0; i < bodies.body.size(); ++i) {
    const Vector3 linear = point_velocity(k, int(i), m.centre[i]);
    const Vector3 spin = k.from_world[i].E.transpose() * k.velocity[i].head<3>();
    w.body[i].velocity = {Real(linear.x()), Real(linear.y()), Real(linear.z())};
    w.body[i].angular_velocity = {Real(spin.x()), Real(spin.y()), Real(spin.z())};
  }
  sim::StepSettings settings;
  settings.step = Real(engine_step);
  const auto simulation = simulate(backend, w, settings);
  simulation->advance(Index(std::lround(seconds / engine_step)));
  const double h = 1e-3;
  for (int i = 0; i < std::lround(seconds / h); ++i) step(m, q, v, h);
  const Kinematics after = kinematics(m.reduced.tree, q, v);
  const auto end = simulation->bodies(0);
  Flight f;
  f.drift = drift(w, end);
  for (std::size_t i = 0; i < end.size(); ++i) {
    f.place =
        std::max(f.place, (multibody::vector(end[i].position) - point_position(after, int(i), m.centre[i])).norm());
    const Matrix3 turned = rotation(end[i].orientation) * rotation(w.body[i].orientation).transpose();
    f.turn = std::max(f.turn, Eigen::AngleAxisd(Matrix3(turned * after.from_world[i].E)).angle());
  }
  return f;
}

}  // namespace

TEST_CASE("the ways to the accelerations agree on the trees of all shipped vehicles") {
  std::mt19937 random(19);
  std::uniform_real_distribution<double> u(-1, 1);
  for (const char* name : {"hmmwv", "fed_alpha", "m113", "viper", "mgru3_rover", "mgru3"}) {
    const Model m(name);
    const Tree& tree = m.reduced.tree;
    const int n = tree.velocity_count();
    VectorX by(n), v(n), tau(n);
    for (int i = 0; i < n; ++i) {
      by(i) = 0.3 * u(random);
      v(i) = u(random);
      tau(i) = 500 * u(random);
    }
    const VectorX q = moved(tree, tree.zero_position(), by, 1);
    const VectorX bias = inverse_dynamics(tree, q, v, VectorX::Zero(n), kDown);
    const VectorX direct = mass_matrix_by_unit_vectors(tree, q).llt().solve(tau - bias);
    const double size = direct.norm();
    const double articulated = (forward_by_articulated_bodies(tree, q, v, tau, kDown) - direct).norm() / size;
    const double divided = (forward_by_divide_and_conquer(tree, q, v, tau, kDown) - direct).norm() / size;
    const double assembled = (forward_by_assembly(tree, q, v, tau, kDown) - direct).norm() / size;
    CHECK(agrees(std::string(name) + ", assembly and disassembly", 0, assembled, 1e-10));
    CHECK(agrees(std::string(name) + ", articulated bodies", 0, articulated, 1e-10));
    CHECK(agrees(std::string(name) + ", divide and conquer", 0, divided, 1e-10));
  }
}

TEST_CASE("the HMMWV's four wishbone suspensions each have one degree of freedom, and its wheels turn") {
  const Model m("hmmwv");
  const VectorX q = m.reduced.tree.zero_position(), rest = VectorX::Zero(m.reduced.tree.velocity_count());
  const LoopEquations e = loop_equations(m.reduced.tree, m.reduced.loop, kinematics(m.reduced.tree, q, rest), rest);
  CHECK(agrees("loops in the design position [m]", 0, e.error.cwiseAbs().maxCoeff(), 1e-12));
  const Eigen::FullPivLU<MatrixX> lu(e.jacobian);
  // 6 of the chassis, 4 suspensions, 4 axles.
  CHECK(m.reduced.tree.velocity_count() - lu.rank() == 14);
}

TEST_CASE("a thrown HMMWV tumbles in reduced coordinates as in the contact engine") {
  const Model m("hmmwv");
  for (const sim::Backend backend : backends()) {
    const std::string name = std::string(name_of(backend)) + ", ";
    const Flight coarse = fly(backend, m, 0.2, 5e-4), fine = fly(backend, m, 0.2, 2.5e-4);
    CHECK(agrees(name + "place after 0.2 s, h 0.5 ms [m]", 0, coarse.place, 1e-3));
    CHECK(agrees(name + "place after 0.2 s, h 0.25 ms [m]", 0, fine.place, 5e-4));
    CHECK(agrees(name + "turn after 0.2 s, h 0.25 ms [rad]", 0, fine.turn, 2e-4));
    CHECK(agrees(name + "halving the step halves the difference", 0.5, fine.place / coarse.place, 0.15));
    CHECK(agrees(name + "drift of the joints [m]", 0, fine.drift, 1e-4));
  }
}

namespace {

/// The vehicle over a plane, its wheels as spheres, which touch where their middle planes do, its brakes on.
struct Standing {
  sim::SceneWorld world;
  EngineBodies bodies;
};

Standing standing(const Model& m) {
  Standing s;
  sim::SceneWorld& w = s.world;
  w.origin = {-20, -20, -2};
  w.size = {40, 40, 10};
  w.set_law(0, 0, {Real(0.9), 0, 0});
  const Vec3d origin{0, 0, -weigh(m.vehicle).ground};
  s.bodies = add_bodies(w, m.assembly, origin);
  add_struts(w, m.assembly, s.bodies, origin);
  for (const int wheel : m.assembly.wheel) {
    sim::Shape tyre;
    tyre.body = s.bodies.body[wheel];
    tyre.size = {Real(0.467), 0, 0};
    w.add_shape(tyre);
  }
  for (std::size_t l = 0; l < m.assembly.link.size(); ++l)
    if (m.assembly.link[l].wheel) w.motor.push_back(sim::speed_motor(w.joint[s.bodies.joint[l]], 0, 4000));
  add_plane(w);
  return s;
}

/// Accelerations in reduced coordinates at the engine's pose, under its contact forces and brakes.
VectorX acceleration_at(const Model& m, sim::Simulation& simulation, const Standing& s) {
  const VectorX q = tree_position(m.reduced, m.centre, s.world.body, simulation.bodies(0));
  const VectorX rest = VectorX::Zero(m.reduced.tree.velocity_count());
  const Kinematics k = kinematics(m.reduced.tree, q, rest);
  const LoopEquations e = loop_equations(m.reduced.tree, m.reduced.loop, k, rest);
  CHECK(agrees("loops at the engine's pose [m]", 0, e.error.cwiseAbs().maxCoeff(), 1e-4));
  VectorX brake = rest;
  auto force = strut_forces(m.reduced, m.assembly.strut, k);
  for (std::size_t i = 0; i < 4; ++i) {
    const int wheel = m.assembly.wheel[i];
    const auto on = simulation.contact_force(0, s.bodies.body[wheel]);
    const Vector3 at = point_position(k, wheel, m.centre[wheel]) - Vector3(0, 0, 0.467);
    force[wheel] += force_at(k.from_world[wheel].point(at), k.from_world[wheel].E * Vector3(on.x, on.y, on.z));
    brake(m.reduced.axle[i]) = simulation.motor_torque(0, Index(i));
  }
  return forward_with_loops(m.reduced.tree, m.reduced.loop, q, rest, brake, kDown, force).acceleration;
}

}  // namespace

TEST_CASE("the HMMWV that the engine has let settle on rigid ground is in equilibrium in reduced coordinates") {
  const Model m("hmmwv");
  const auto load = static_loads(m.vehicle);
  for (const sim::Backend backend : backends()) {
    const Standing s = standing(m);
    sim::StepSettings settings;
    settings.iterations = 60;
    const auto simulation = simulate(backend, s.world, settings);
    advance_for(*simulation, 5);
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const double on = simulation->contact_force(0, s.bodies.body[m.assembly.wheel[i]]).z;
      CHECK(agrees("load of wheel " + std::to_string(i) + " [N]", load[i], on, 0.01 * load[i]));
      sum += on;
    }
    CHECK(agrees("sum of the loads [N]", weigh(m.vehicle).total * kGravity, sum, 1e-4 * sum));
    const VectorX dv = acceleration_at(m, *simulation, s);
    CHECK(agrees("acceleration of the chassis [m/s^2]", 0, dv.segment<3>(3).norm(), 0.002));
    CHECK(agrees("turning of the chassis [rad/s^2]", 0, dv.head<3>().norm(), 0.001));
    CHECK(agrees("largest joint acceleration [rad/s^2]", 0, dv.tail(dv.size() - 6).cwiseAbs().maxCoeff(), 0.05));
  }
}
