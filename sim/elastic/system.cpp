#include "sim/elastic/system.h"

#include <numbers>

#include "base/error.h"
#include "sim/elastic/element_matrices.h"

namespace gonogo::sim::elastic {
namespace {

Model checked(Model model) {
  check_model(model);
  return model;
}

std::vector<int> first_dofs(const Model& model) {
  std::vector<int> first{0};
  for (const Body& b : model.body) first.push_back(first.back() + int(b.mesh.node.size()) * dimension_of(b.mesh.kind));
  return first;
}

void add_element(const System& s, int body, std::size_t e, const ElementMatrix& m, Triplets& to) {
  const Mesh& mesh = s.model.body[std::size_t(body)].mesh;
  const auto global = [&](int local) {
    return s.dof(body, mesh.element[e][std::size_t(local / s.dimension)], local % s.dimension);
  };
  for (int i = 0; i < m.rows(); ++i)
    for (int j = 0; j < m.cols(); ++j)
      if (m(i, j) != 0) to.emplace_back(global(i), global(j), m(i, j));
}

Sparse square(int size, const Triplets& triplets) {
  Sparse m(size, size);
  m.setFromTriplets(triplets.begin(), triplets.end());
  return m;
}

}  // namespace

System::System(Model given)
    : model(checked(std::move(given))),
      dimension(dimension_of(model.body[0].mesh.kind)),
      first(first_dofs(model)),
      dofs(first.back()),
      free(std::size_t(dofs), 0),
      lumped(Vector::Zero(dofs)),
      contact(model, first) {
  Triplets k, m;
  for (std::size_t b = 0; b < model.body.size(); ++b)
    for (std::size_t e = 0; e < model.body[b].mesh.element.size(); ++e) {
      add_element(*this, int(b), e, stiffness_of(model.body[b], e), k);
      add_element(*this, int(b), e, consistent_mass_of(model.body[b], e), m);
      const Vector masses = lumped_mass_of(model.body[b], e);
      for (int c = 0; c < masses.size(); ++c)
        for (int d = 0; d < dimension; ++d)
          lumped[dof(int(b), model.body[b].mesh.element[e][std::size_t(c)], d)] += masses[c];
    }
  stiffness = square(dofs, k);
  mass = square(dofs, m);
  stiffest = stiffness.diagonal().maxCoeff();
  for (const Fixed& f : model.fixed)
    for (const Index n : f.node) free[std::size_t(dof(f.body, n, f.component))] = -1;
  for (int& f : free)
    if (f == 0) f = free_count++;
  if (free_count == 0) throw InputError("every displacement is fixed, so that nothing is left to compute; free a node");
  free_stiffness = freed(stiffness);
  free_mass = freed(mass);
}

Vector System::loads(double time) const {
  Vector f = Vector::Zero(dofs);
  const double g[3] = {model.gravity.x, model.gravity.y, model.gravity.z};
  for (int i = 0; i < dofs; ++i) f[i] = lumped[i] * g[i % dimension];  // first of a body is a multiple of the dimension
  for (const Traction& t : model.traction) {
    const Body& b = model.body[std::size_t(t.body)];
    const Vec3d p = t.traction(time);
    const double component[3] = {p.x, p.y, p.z};
    for (const Face& face : t.face) {
      std::array<Vec3d, 4> x{};
      for (int k = 0; k < face.count; ++k) x[k] = b.mesh.node[std::size_t(face.node[k])];
      for (const FacePoint& q : face_quadrature(face.count, 2)) {
        double area = q.weight * face_measure(face.count, q, x), radius = 0;
        for (int k = 0; k < face.count; ++k) radius += q.n[k] * x[k].x;
        if (dimension == 2) area *= b.plane == Plane::axisymmetric ? 2 * std::numbers::pi * radius : b.thickness;
        for (int k = 0; k < face.count; ++k)
          for (int c = 0; c < dimension; ++c) f[dof(t.body, face.node[k], c)] += component[c] * q.n[k] * area;
      }
    }
  }
  return f;
}

Vector System::strained(const Vector& u) const {
  Vector rest = u;
  for (std::size_t b = 0; b < model.body.size(); ++b) {
    const bool axisymmetric = dimension == 2 && model.body[b].plane == Plane::axisymmetric;
    for (int c = axisymmetric ? 1 : 0; c < dimension; ++c) {
      double sum = 0;
      for (int i = first[b] + c; i < first[b + 1]; i += dimension) sum += u[i];
      const double mean = sum / double(model.body[b].mesh.node.size());
      for (int i = first[b] + c; i < first[b + 1]; i += dimension) rest[i] -= mean;
    }
  }
  return rest;
}

void System::fix(double time, Vector& u) const {
  for (const Fixed& f : model.fixed) {
    const double value = f.displacement(time);
    for (const Index n : f.node) u[dof(f.body, n, f.component)] = value;
  }
}

Vector System::freed(const Vector& all) const {
  Vector f(free_count);
  for (int i = 0; i < dofs; ++i)
    if (free[std::size_t(i)] >= 0) f[free[std::size_t(i)]] = all[i];
  return f;
}

Sparse System::freed(const Sparse& all) const {
  Triplets t;
  for (int c = 0; c < all.outerSize(); ++c)
    for (Sparse::InnerIterator it(all, c); it; ++it) t.emplace_back(int(it.row()), int(it.col()), it.value());
  return freed(t);
}

Sparse System::freed(const Triplets& all) const {
  Triplets t;
  for (const auto& e : all)
    if (free[std::size_t(e.row())] >= 0 && free[std::size_t(e.col())] >= 0)
      t.emplace_back(free[std::size_t(e.row())], free[std::size_t(e.col())], e.value());
  return square(free_count, t);
}

void System::need_density() const {
  for (const Body& b : model.body)
    if (!(b.material.density > 0))
      throw InputError(b.name + " has no density, which dynamics need; give it in kg/m^3, above 0");
}

}  // namespace gonogo::sim::elastic
