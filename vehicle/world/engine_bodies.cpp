#include "vehicle/world/engine_bodies.h"

#include <Eigen/Dense>
#include <algorithm>

#include "sim/scene/scene.h"

namespace gonogo::vehicle {
namespace {

sim::BodyIndex add_part(sim::SceneWorld& world, const Part& p, const Vec3d& origin) {
  Eigen::MatrixXd inertia(3, 3);
  inertia << p.moments.x, p.products.x, p.products.y, p.products.x, p.moments.y, p.products.z, p.products.y,
      p.products.z, p.moments.z;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> principal(inertia);
  Eigen::Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) *= -1;
  const Eigen::Quaterniond turn(axes);
  const Eigen::VectorXd& moment = principal.eigenvalues();
  sim::BodyState state;
  state.position = origin + p.centre;
  state.orientation = {Real(turn.w()), Real(turn.x()), Real(turn.y()), Real(turn.z())};
  return world.add_body(state, sim::solid(Real(p.mass), {Real(moment(0)), Real(moment(1)), Real(moment(2))}));
}

/// Lengths at which a spring's push has a corner, those of its stops included: outside of the stops' tables nothing is
/// known but that the stop goes on.
std::vector<double> corners(const Spring& s) {
  std::vector<double> at = s.force.at;
  if (!s.stop.empty()) {
    const double reach = s.stop.at.back();
    std::erase_if(at, [&](double x) { return x < s.shortest - reach || x > s.longest + reach; });
    for (const double pressed : s.stop.at) at.insert(at.end(), {s.shortest - pressed, s.longest + pressed});
  }
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end(), [](double a, double b) { return b - a < 1e-6; }), at.end());
  return at;
}

/// Pull of a spring over its stretch beyond `free`: all corners of its push, or those around the length it has now.
sim::ForceTable stretch_table(const Spring& s, double now, double free) {
  const std::vector<double> at = corners(s);
  const int count = std::min<int>(int(at.size()), sim::kMaxTablePoints);
  const int above = int(std::upper_bound(at.begin(), at.end(), now) - at.begin());
  const int first = std::clamp(above - count / 2, 0, int(at.size()) - count);
  std::vector<std::pair<double, double>> points;
  for (int i = first; i < first + count; ++i) points.emplace_back(at[i] - free, -s.push(at[i]));
  return sim::force_table(points);
}

double slope_at_rest(const Curve& damper) {
  const double speed = 0.01;  // [m/s]
  return (damper(-speed) - damper(speed)) / (2 * speed);
}

}  // namespace

EngineBodies add_bodies(sim::SceneWorld& world, const Assembly& assembly, const Vec3d& origin) {
  EngineBodies e;
  for (const Part& p : assembly.body) e.body.push_back(add_part(world, p, origin));
  for (const Link& link : assembly.link) {
    const sim::BodyIndex a = e.body[link.child], b = e.body[link.parent];
    const Vec3d at = origin + link.point;
    e.joint.push_back(Index(world.joint.size()));
    if (link.type == LinkType::revolute) world.joint.push_back(sim::revolute(world, a, b, at, link.axis));
    if (link.type == LinkType::prismatic) world.joint.push_back(sim::prismatic(world, a, b, at, link.axis));
    if (link.type == LinkType::spherical) world.joint.push_back(sim::spherical(world, a, b, at));
    if (link.type == LinkType::distance)
      world.joint.push_back(sim::distance(world, a, b, at, origin + link.parent_point));
  }
  return e;
}

void add_struts(sim::SceneWorld& world, const Assembly& assembly, const EngineBodies& bodies, const Vec3d& origin) {
  for (const Strut& s : assembly.strut) {
    const double damping = s.damper && !s.damper->force.empty() ? slope_at_rest(s.damper->force) : 0;
    sim::SpringDamper spring = sim::spring_between(world, bodies.body[s.child], bodies.body[s.parent],
                                                   origin + s.child_point, origin + s.parent_point, 0, damping);
    if (s.spring) spring.table = stretch_table(*s.spring, length(s.child_point - s.parent_point), spring.free_length);
    world.spring.push_back(spring);
  }
}

Index add_motor(sim::SceneWorld& world, const sim::Motor& motor) {
  world.motor.push_back(motor);
  return Index(world.motor.size()) - 1;
}

}  // namespace gonogo::vehicle
