// Elements against what any displacement field must keep: no force from moving as a whole, all mass, and work.
#include <cmath>

#include "sim/elastic/mesh.h"
#include "sim/elastic/simulation.h"
#include "sim/elastic/system.h"
#include "tests/support/catch.h"

namespace {

using namespace gonogo;
using namespace gonogo::sim::elastic;

Body skewed(ElementKind kind, Plane plane = Plane::strain) {
  const std::vector<double> p = even(1, 2, 2);
  Mesh mesh = dimension_of(kind) == 2 ? make_rectangle(p, p, kind) : make_box(p, p, p, kind);
  for (Vec3d& x : mesh.node)
    x = {x.x + 0.2 * x.y, x.y + 0.1 * x.x * x.x, dimension_of(kind) == 3 ? x.z + 0.15 * x.x * x.y : 0};
  return {"skewed", mesh, {2e9, 0.3, 1200}, plane, 0.7};
}

Eigen::VectorXd nodal(const Body& b, std::size_t e, Vec3d (*field)(const Vec3d&)) {
  const int d = dimension_of(b.mesh.kind), corners = corner_count(b.mesh.kind);
  Eigen::VectorXd u(corners * d);
  for (int k = 0; k < corners; ++k) {
    const Vec3d v = field(b.mesh.node[std::size_t(b.mesh.element[e][std::size_t(k)])]);
    for (int c = 0; c < d; ++c) u[k * d + c] = c == 0 ? v.x : c == 1 ? v.y : v.z;
  }
  return u;
}

const ElementKind kKinds[] = {ElementKind::t3, ElementKind::q4, ElementKind::t4, ElementKind::h8};

}  // namespace

TEST_CASE("Moving or turning as a whole costs no force") {
  for (const ElementKind kind : kKinds) {
    const Body b = skewed(kind);
    for (std::size_t e = 0; e < b.mesh.element.size(); ++e) {
      const ElementMatrix k = stiffness_of(b, e);
      const double scale = k.norm();
      CHECK((k * nodal(b, e, [](const Vec3d&) { return Vec3d{1, 2, 3}; })).norm() < 1e-12 * scale);
      CHECK((k * nodal(b, e, [](const Vec3d& x) { return Vec3d{-x.y, x.x, 0}; })).norm() < 1e-12 * scale);
      CHECK((k - k.transpose()).norm() < 1e-12 * scale);
    }
  }
}

TEST_CASE("Stiffness has as many modes without force as rigid motions") {
  const int rigid[] = {3, 3, 6, 6};
  for (int i = 0; i < 4; ++i) {
    const ElementMatrix k = stiffness_of(skewed(kKinds[i]), 0);
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k).eigenvalues();
    CHECK((values.array() < 1e-10 * values.maxCoeff()).count() == rigid[i]);
  }
}

TEST_CASE("Energy of a constant strain is volume times its density") {
  // Uniaxial strain e along x: density (lambda + 2 mu) e^2 / 2; plane stress: E / (1 - nu^2) e^2 / 2.
  const auto stretch = [](const Vec3d& x) { return Vec3d{1e-3 * x.x, 0, 0}; };
  for (const ElementKind kind : kKinds) {
    const Body b = skewed(kind);
    double energy = 0, volume = 0;
    for (std::size_t e = 0; e < b.mesh.element.size(); ++e) {
      const Eigen::VectorXd u = nodal(b, e, stretch);
      energy += 0.5 * u.dot(stiffness_of(b, e) * u);
      volume += lumped_mass_of(b, e).sum() / b.material.density;
    }
    const double modulus = 2e9 * 0.7 / (1.3 * 0.4);
    CHECK(std::fabs(energy / (0.5 * modulus * 1e-6 * volume) - 1) < 1e-12);
  }
}

TEST_CASE("Mass of both kinds adds up to density times volume") {
  for (const ElementKind kind : kKinds) {
    const Body b = skewed(kind);
    const int d = dimension_of(kind);
    double consistent = 0, lumped = 0, volume = 0;
    for (std::size_t e = 0; e < b.mesh.element.size(); ++e) {
      const Eigen::VectorXd one = nodal(b, e, [](const Vec3d&) { return Vec3d{1, 0, 0}; });
      consistent += one.dot(consistent_mass_of(b, e) * one);
      lumped += lumped_mass_of(b, e).sum();
      for (const QuadraturePoint& q : quadrature_of(kind))
        volume += q.weight * gradient_of(b.mesh, e, shape_values(kind, q.at)).determinant * (d == 2 ? b.thickness : 1);
    }
    CHECK(std::fabs(consistent / (1200 * volume) - 1) < 1e-12);
    CHECK(std::fabs(lumped / (1200 * volume) - 1) < 1e-12);
  }
}

TEST_CASE("Thick tube under pressure against Lame") {
  // Axisymmetric and plane strain must give Lame's displacement of the inner wall; Timoshenko & Goodier, section 28.
  const double a = 0.1, b = 0.2, p = 1e6, young = 1e9, nu = 0.3;
  const double closed = (1 + nu) / young * p * a * a / (b * b - a * a) * ((1 - 2 * nu) * a + b * b / a);
  Model model;
  model.body = {{"tube", make_rectangle(even(a, b, 40), {0, 0.01}), {young, nu, 0}, Plane::axisymmetric}};
  const Mesh& mesh = model.body[0].mesh;
  model.fixed = {{0, nodes_where(mesh, [](const Vec3d&) { return true; }), 1}};
  model.traction = {{0, faces_where(mesh, [&](const Vec3d& x) { return std::fabs(x.x - a) < 1e-9; }), [p](double) {
                       return Vec3d{p, 0, 0};
                     }}};
  Simulation s(model);
  REQUIRE(s.statics({.end = 1, .step = 1}).finished);
  CHECK(std::fabs(s.displacement(0, 0).x / closed - 1) < 2e-3);

  const double pi = 3.14159265358979323846;
  Model ring;
  ring.body = {{"ring", make_ring_sector(even(a, b, 40), even(0, pi / 2, 40)), {young, nu, 0}}};
  const Mesh& m = ring.body[0].mesh;
  ring.fixed = {{0, nodes_where(m, [](const Vec3d& x) { return std::fabs(x.x) < 1e-9; }), 0},
                {0, nodes_where(m, [](const Vec3d& x) { return std::fabs(x.y) < 1e-9; }), 1}};
  for (const Face& f : faces_where(m, [&](const Vec3d& x) { return std::hypot(x.x, x.y) < a + 1e-4; })) {
    const Vec3d middle = (m.node[std::size_t(f.node[0])] + m.node[std::size_t(f.node[1])]) * 0.5;
    const Vec3d out = middle * (p / length(middle));
    ring.traction.push_back({0, {f}, [out](double) { return out; }});
  }
  Simulation r(ring);
  REQUIRE(r.statics({.end = 1, .step = 1}).finished);
  CHECK(std::fabs(length(r.displacement(0, 0)) / closed - 1) < 2e-3);
}
