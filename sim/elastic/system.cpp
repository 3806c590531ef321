#include "sim/elastic/system.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "base/progress.h"

namespace gonogo::sim::elastic {

Matrix6 elasticity(const Material& m, bool plane_stress) {
  const double shear = m.young / (2 * (1 + m.poisson));
  Matrix6 d = Matrix6::Zero();
  if (plane_stress) {
    const double c = m.young / (1 - m.poisson * m.poisson);
    d(0, 0) = d(1, 1) = c;
    d(0, 1) = d(1, 0) = c * m.poisson;
    d(3, 3) = shear;
    return d;
  }
  const double lambda = m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson));
  d.topLeftCorner<3, 3>().setConstant(lambda);
  for (int i = 0; i < 3; ++i) {
    d(i, i) += 2 * shear;
    d(i + 3, i + 3) = shear;
  }
  return d;
}

StrainMatrix strain_matrix(int corners, int dimension, const Gradient& g, const ShapeValues& s, double radius) {
  StrainMatrix b = StrainMatrix::Zero(6, corners * dimension);
  for (int k = 0; k < corners; ++k) {
    const Vec3d& slope = g.slope[std::size_t(k)];
    const int at = k * dimension;
    b(0, at) = b(3, at + 1) = slope.x;
    b(1, at + 1) = b(3, at) = slope.y;
    if (dimension == 3) {
      b(2, at + 2) = b(4, at + 1) = b(5, at) = slope.z;
      b(4, at + 2) = slope.y;
      b(5, at + 2) = slope.x;
    } else if (radius > 0) {
      b(2, at) = s.n[std::size_t(k)] / radius;
    }
  }
  return b;
}

PointVolume volume_at(const Body& body, std::size_t element, const QuadraturePoint& q, const ShapeValues& s,
                      const Gradient& g) {
  PointVolume v;
  v.volume = q.weight * g.determinant;
  if (dimension_of(body.mesh.kind) == 3) return v;
  if (body.plane != Plane::axisymmetric) {
    v.volume *= body.thickness;
    return v;
  }
  for (int k = 0; k < corner_count(body.mesh.kind); ++k)
    v.radius += s.n[std::size_t(k)] * body.mesh.node[std::size_t(body.mesh.element[element][std::size_t(k)])].x;
  v.volume *= 2 * std::numbers::pi * v.radius;
  return v;
}

ElementMatrix stiffness_of(const Body& body, std::size_t element) {
  const int dimension = dimension_of(body.mesh.kind), corners = corner_count(body.mesh.kind);
  const Matrix6 d = elasticity(body.material, dimension == 2 && body.plane == Plane::stress);
  ElementMatrix k = ElementMatrix::Zero(corners * dimension, corners * dimension);
  for (const QuadraturePoint& q : quadrature_of(body.mesh.kind)) {
    const ShapeValues s = shape_values(body.mesh.kind, q.at);
    const Gradient g = gradient_of(body.mesh, element, s);
    const PointVolume v = volume_at(body, element, q, s, g);
    const StrainMatrix b = strain_matrix(corners, dimension, g, s, v.radius);
    k += b.transpose() * d * b * v.volume;
  }
  return k;
}

ElementMatrix consistent_mass_of(const Body& body, std::size_t element) {
  const int dimension = dimension_of(body.mesh.kind), corners = corner_count(body.mesh.kind);
  ElementMatrix m = ElementMatrix::Zero(corners * dimension, corners * dimension);
  for (const QuadraturePoint& q : quadrature_of(body.mesh.kind)) {
    const ShapeValues s = shape_values(body.mesh.kind, q.at);
    const double mass =
        body.material.density * volume_at(body, element, q, s, gradient_of(body.mesh, element, s)).volume;
    for (int a = 0; a < corners; ++a)
      for (int b = 0; b < corners; ++b)
        for (int c = 0; c < dimension; ++c)
          m(a * dimension + c, b * dimension + c) += mass * s.n[std::size_t(a)] * s.n[std::size_t(b)];
  }
  return m;
}

Eigen::VectorXd lumped_mass_of(const Body& body, std::size_t element) {
  const int dimension = dimension_of(body.mesh.kind), corners = corner_count(body.mesh.kind);
  const Eigen::VectorXd sums = consistent_mass_of(body, element).rowwise().sum();
  Eigen::VectorXd mass(corners);
  for (int k = 0; k < corners; ++k) mass[k] = sums[k * dimension];
  return mass;
}

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

namespace {

struct Residual {
  Vector r;                                   // [free]
  double norm = 0, scale = 0, round_off = 0;  // [N]
  double compliance_energy = 0;
  double relative() const { return scale > 0 ? norm / scale : norm; }
};

Residual residual_of(const ImplicitStep& s, const Vector& u, Triplets* tangent, std::vector<ContactPoint>* points) {
  Residual out;
  const Forces f = forces_at(s.system, u, s.velocity(u), s.rate, s.time, s.step, tangent, points);
  Vector all = (1 + s.alpha) * f.g;
  const double eps = std::numeric_limits<double>::epsilon();
  out.round_off = eps * s.system.stiffest * u.norm();  // displacements are known to eps of themselves
  out.scale = f.scale;
  if (s.inertia > 0) {
    const Vector inertial = s.system.mass * s.acceleration(u);
    all -= inertial;
    out.round_off += eps * s.inertia * s.system.lumped.maxCoeff() * u.norm();
    if (s.alpha != 0) all -= s.alpha * s.g_before;
    out.scale = std::max(out.scale, inertial.norm());
  }
  out.r = s.system.freed(all);
  out.norm = out.r.norm();
  out.compliance_energy = f.compliance_energy;
  return out;
}

/// Correction of the free displacements; empty when the matrix is singular. Without friction it is symmetric.
Vector correction(const ImplicitStep& s, const Triplets& contact, const Vector& r) {
  Sparse matrix = (1 + s.alpha) * (s.system.free_stiffness + s.system.freed(contact));
  if (s.inertia > 0) matrix += s.inertia * s.system.free_mass;
  matrix.makeCompressed();
  Vector du;
  if (s.system.contact.has_friction()) {
    Eigen::SparseLU<Sparse> lu(matrix);
    if (lu.info() == Eigen::Success) du = lu.solve(r);
  } else {
    Eigen::SimplicialLDLT<Sparse> ldlt(matrix);
    if (ldlt.info() == Eigen::Success) du = ldlt.solve(r);
  }
  if (du.size() > 0 && !du.allFinite()) du.resize(0);
  return du;
}

Vector corrected(const System& system, const Vector& u, const Vector& du, double share) {
  Vector next = u;
  for (int i = 0; i < system.dofs; ++i)
    if (system.free[std::size_t(i)] >= 0) next[i] += share * du[system.free[std::size_t(i)]];
  return next;
}

/// Halves the correction until the residual falls; takes the least residual met if it never does.
Vector searched(const ImplicitStep& s, const Vector& u, const Vector& du, double norm, bool search,
                StepReport& report) {
  if (!search) return corrected(s.system, u, du, 1);
  Vector best;
  double least = std::numeric_limits<double>::infinity();
  for (double share = 1; share > 1e-3; share /= 2) {
    Vector next = corrected(s.system, u, du, share);
    const double met = residual_of(s, next, nullptr, nullptr).norm;
    if (met < least) {
      least = met;
      best = std::move(next);
    }
    if (met <= (1 - 1e-4 * share) * norm) break;
    ++report.halvings;
  }
  return best.size() > 0 ? best : corrected(s.system, u, du, 1);
}

}  // namespace

Forces forces_at(const System& system, const Vector& u, const Vector& v, double rate, double time, double step,
                 Triplets* tangent, std::vector<ContactPoint>* points) {
  stop_if_cancelled();  // every step of every march comes by here
  Forces f;
  const Vector loads = system.loads(time), elastic = system.stiffness * system.strained(u);
  Vector contact = Vector::Zero(system.dofs);
  f.compliance_energy = system.contact.add({u, v, rate, time, step}, contact, tangent, points);
  f.scale = std::max({loads.norm(), elastic.norm(), contact.norm()});
  f.g = loads - elastic + contact;
  return f;
}

NewtonResult solve_step(const ImplicitStep& step, Vector u, const NewtonSettings& settings, StepReport& report) {
  NewtonResult result;
  for (int i = 0;; ++i) {
    Triplets tangent;
    const Residual r = residual_of(step, u, &tangent, &result.points);
    report.residual.push_back(r.relative());
    report.iterations = i;
    if (r.norm <= std::max(settings.tolerance * r.scale, r.round_off)) {
      result.converged = true;
      result.compliance_energy = r.compliance_energy;
      break;
    }
    if (i == settings.max_iterations) {
      result.reason = "Newton's method did not converge in " + std::to_string(i) + " iterations";
      break;
    }
    const Vector du = correction(step, tangent, r.r);
    if (du.size() == 0) {
      result.reason = "the tangent matrix is singular: a body is held by nothing";
      break;
    }
    u = searched(step, u, du, r.norm, settings.line_search, report);
  }
  result.u = std::move(u);
  return result;
}

}  // namespace gonogo::sim::elastic
