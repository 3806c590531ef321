// Contact forces: consistent tangents against differences, actio and reactio, the law against its definition.
#include <cmath>
#include <random>
#include <utility>

#include "sim/elastic/contact.h"
#include "sim/elastic/mesh.h"
#include "tests/support/catch.h"

namespace {

using namespace gonogo;
using namespace gonogo::sim::elastic;

Mesh block(bool solid, ElementKind kind) {
  const std::vector<double> p = even(0, 1, 3);
  return solid ? make_box(p, p, p, kind) : make_rectangle(p, p, kind);
}

std::vector<Face> side(const Mesh& mesh, double y) {
  return faces_where(mesh, [y](const Vec3d& x) { return std::fabs(x.y - y) < 1e-9; });
}

ContactLaw law(double m_n, double m_t) { return {.c_n = 1e6, .m_n = m_n, .c_t = 4e5, .m_t = m_t, .epsilon = 0.05}; }

Model on_shape(ElementKind kind, RigidShape shape) {
  Model m;
  m.body = {{"block", block(dimension_of(kind) == 3, kind), {1e7, 0.3, 0}}};
  Contact c;
  c.face = side(m.body[0].mesh, 0);
  c.shape = std::move(shape);
  c.law = law(1.5, 2.5);
  m.contact.push_back(c);
  return m;
}

Model on_block(ElementKind own, ElementKind other) {
  Model m;
  const bool solid = dimension_of(own) == 3;
  const Mesh upper = moved(block(solid, own), [](const Vec3d& x) {
    return Vec3d{0.8 * x.x + 0.1, x.y + 0.98 + 0.03 * x.x, 0.7 * x.z + 0.13 * (x.z != 0)};
  });
  m.body = {{"lower", block(solid, other), {1e7, 0.3, 0}}, {"upper", upper, {1e7, 0.3, 0}}};
  const auto low = faces_where(upper, [&](const Vec3d& x) { return x.y < 1.02 && x.y > 0.9; });
  Contact c;
  c.body = 1;
  c.face = low;
  c.other = 0;
  c.other_face = side(m.body[0].mesh, 1);
  c.law = law(2, 1);
  c.reach = 0.5;
  m.contact.push_back(c);
  return m;
}

struct State1 {
  Vector u, v;
};

State1 random_state(int dofs, double u, double v) {
  std::mt19937 draw(7);
  std::uniform_real_distribution<double> spread(-1, 1);
  State1 s{Vector(dofs), Vector(dofs)};
  for (int i = 0; i < dofs; ++i) {
    s.u[i] = u * spread(draw);
    s.v[i] = v * spread(draw);
  }
  return s;
}

/// Largest difference of the tangent from central differences, over the largest of its entries.
double tangent_error(const Model& model, double spread_v) {
  std::vector<int> first{0};
  for (const Body& b : model.body) first.push_back(first.back() + int(b.mesh.node.size()) * dimension_of(b.mesh.kind));
  const ContactForces forces(model, first);
  const int dofs = first.back();
  const double rate = 30;
  const State1 s = random_state(dofs, 0.01, spread_v);
  Vector at = Vector::Zero(dofs);
  Triplets triplets;
  forces.add({s.u, s.v, rate, 1, 0.1}, at, &triplets, nullptr);
  Eigen::MatrixXd tangent = Eigen::MatrixXd::Zero(dofs, dofs);
  for (const auto& t : triplets) tangent(t.row(), t.col()) += t.value();
  REQUIRE(at.norm() > 0);
  double error = 0;
  for (int i = 0; i < dofs; ++i) {
    const double h = 1e-7;
    Vector sum = Vector::Zero(dofs);
    for (const double sign : {1.0, -1.0}) {
      Vector u = s.u, v = s.v, f = Vector::Zero(dofs);
      u[i] += sign * h;
      v[i] += sign * h * rate;
      forces.add({u, v, rate, 1, 0.1}, f, nullptr, nullptr);
      sum -= sign / (2 * h) * f;
    }
    error = std::max(error, (sum - tangent.col(i)).cwiseAbs().maxCoeff());
  }
  return error / tangent.cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("Tangents of contact with rigid shapes agree with differences") {
  const RigidShape plane{.kind = RigidKind::half_space, .point = {0, 0.02, 0}, .axis = {0, 1, 0}};
  const RigidShape ball{.kind = RigidKind::ball, .point = {0.45, -1.9, 0.4}, .radius = 2};
  const RigidShape cylinder{.kind = RigidKind::cylinder, .point = {0.45, -1.9, 0.4}, .axis = {0, 0, 1}, .radius = 2};
  for (const double speed : {0.02, 1.0}) {  // sticks, slips
    for (const ElementKind kind : {ElementKind::t3, ElementKind::q4, ElementKind::t4, ElementKind::h8}) {
      CHECK(tangent_error(on_shape(kind, plane), speed) < 1e-5);
      CHECK(tangent_error(on_shape(kind, ball), speed) < 1e-5);
    }
    CHECK(tangent_error(on_shape(ElementKind::h8, cylinder), speed) < 1e-5);
  }
}

TEST_CASE("Tangents of contact between bodies agree with differences") {
  for (const double speed : {0.02, 1.0}) {
    CHECK(tangent_error(on_block(ElementKind::q4, ElementKind::t3), speed) < 1e-5);
    CHECK(tangent_error(on_block(ElementKind::h8, ElementKind::h8), speed) < 1e-5);
    CHECK(tangent_error(on_block(ElementKind::t4, ElementKind::t4), speed) < 1e-5);
  }
}

TEST_CASE("Bodies push each other with equal forces and moments") {
  for (const ElementKind kind : {ElementKind::q4, ElementKind::h8}) {
    const Model m = on_block(kind, kind);
    const int d = dimension_of(kind), nodes = int(m.body[0].mesh.node.size());
    const ContactForces forces(m, {0, nodes * d, 2 * nodes * d});
    const State1 s = random_state(2 * nodes * d, 0.01, 0.3);
    Vector f = Vector::Zero(2 * nodes * d);
    forces.add({s.u, s.v, 0, 1, 0.1}, f, nullptr, nullptr);
    Vec3d force, moment;
    double scale = 0;
    for (int b = 0; b < 2; ++b)
      for (int n = 0; n < nodes; ++n) {
        const int at = (b * nodes + n) * d;
        const Vec3d g{f[at], f[at + 1], d == 3 ? f[at + 2] : 0};
        const Vec3d x =
            m.body[std::size_t(b)].mesh.node[std::size_t(n)] + Vec3d{s.u[at], s.u[at + 1], d == 3 ? s.u[at + 2] : 0};
        force += g;
        moment += cross(x, g);
        scale += length(g);
      }
    REQUIRE(scale > 0);
    CHECK(length(force) < 1e-12 * scale);
    // Friction acts at the projection, a penetration away from the Gauss point.
    CHECK(length(moment) < 0.05 * scale);
  }
}

TEST_CASE("Points report the law") {
  const double depth = 0.02;
  Model m = on_shape(ElementKind::q4, {.point = {0, depth, 0}, .axis = {0, 1, 0}});
  const ContactForces forces(m, {0, 32});
  const Vector u = Vector::Zero(32);
  const ContactLaw& l = m.contact[0].law;
  for (const double speed : {0.0, 0.01, 0.049, 0.051, 2.0}) {
    Vector v = Vector::Zero(32), f = Vector::Zero(32);
    for (int i = 0; i < 32; i += 2) v[i] = -speed;
    std::vector<ContactPoint> points;
    const double energy = forces.add({u, v, 0, 0, 0}, f, nullptr, &points);
    const double pressure = l.c_n * std::pow(depth, l.m_n), shear = l.c_t * std::pow(depth, l.m_t);
    REQUIRE(points.size() == 6);
    for (const ContactPoint& p : points) {
      CHECK(std::fabs(p.pressure / pressure - 1) < 1e-12);
      CHECK(std::fabs(p.shear.x - shear * psi_slope(speed, l.epsilon)) < 1e-9 * shear);
      CHECK(p.touch == (speed < l.epsilon ? Touch::stick : Touch::slip));
    }
    CHECK(std::fabs(energy / (l.c_n * std::pow(depth, l.m_n + 1) / (l.m_n + 1)) - 1) < 1e-12);  // per 1 m^2
  }
}

TEST_CASE("psi is convex, smooth and has the slopes it says") {
  const double e = 0.3;
  for (double s = 0.001; s < 1; s += 0.0137) {
    const double h = 1e-6;
    CHECK(std::fabs((psi(s + h, e) - psi(s - h, e)) / (2 * h) - psi_slope(s, e)) < 1e-8);
    if (std::fabs(s - e) > 2 * h)
      CHECK(std::fabs((psi_slope(s + h, e) - psi_slope(s - h, e)) / (2 * h) - psi_curvature(s, e)) < 1e-7);
    CHECK(psi_curvature(s, e) >= 0);
    CHECK(std::fabs(psi(s, e) - s) <= e / 3 + 1e-12);
  }
  CHECK(psi_slope(e, e) == 1);
  CHECK(psi_slope(0, e) == 0);
}

TEST_CASE("Law of a rough surface agrees with the sum over its tips") {
  const RoughSurface s{.density = 1e9, .radius = 2e-5, .height = 1e-5, .modulus = 5e10, .friction = 0.2};
  const ContactLaw l = rough_law(s, 1e-4);
  const int tips = 200000;
  for (const double w : {1e-6, 4e-6, 9e-6}) {
    double force = 0;  // of Hertz's tips per square metre, heights spread evenly below the highest
    for (int i = 0; i < tips; ++i) {
      const double depth = w - s.height * (i + 0.5) / tips;
      if (depth > 0) force += 4.0 / 3 * s.modulus * std::sqrt(s.radius) * std::pow(depth, 1.5);
    }
    force *= s.density / tips;
    CHECK(std::fabs(l.c_n * std::pow(w, l.m_n) / force - 1) < 1e-4);
  }
  CHECK(std::fabs(l.c_t / l.c_n - 0.2) < 1e-15);
}
