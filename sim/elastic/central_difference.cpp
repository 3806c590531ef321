// Central differences with lumped mass, and the largest step at which they are stable.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/line.h"
#include "sim/elastic/largest_eigenvalue.h"
#include "sim/elastic/newton.h"
#include "sim/elastic/shape_functions.h"

namespace gonogo::sim::elastic {
namespace {

using Parts = Simulation::Parts;

/// Least height of an element: its volume over its widest face, times 2 or 3 for triangles and tetrahedra [m].
double height_of(const Mesh& mesh, std::size_t e) {
  double volume = 0, widest = 0;
  for (const QuadraturePoint& q : quadrature_of(mesh.kind))
    volume += q.weight * gradient_of(mesh, e, shape_values(mesh.kind, q.at)).determinant;
  Mesh alone{mesh.kind, mesh.node, {mesh.element[e]}};
  for (const Face& f : boundary_faces(alone)) {
    std::array<Vec3d, 4> x{};
    for (int k = 0; k < f.count; ++k) x[k] = mesh.node[std::size_t(f.node[k])];
    double size = 0;
    for (const FacePoint& p : face_quadrature(f.count, 2)) size += p.weight * face_measure(f.count, p, x);
    widest = std::max(widest, size);
  }
  const double simplex = mesh.kind == ElementKind::t3 ? 2 : mesh.kind == ElementKind::t4 ? 3 : 1;
  return simplex * volume / widest;
}

double wave_step(const Model& model) {
  double least = std::numeric_limits<double>::infinity();
  for (const Body& b : model.body) {
    const Material& m = b.material;
    const bool stress = dimension_of(b.mesh.kind) == 2 && b.plane == Plane::stress;
    const double modulus = stress ? m.young / (1 - m.poisson * m.poisson)
                                  : m.young * (1 - m.poisson) / ((1 + m.poisson) * (1 - 2 * m.poisson));
    const double speed = std::sqrt(modulus / m.density);
    for (std::size_t e = 0; e < b.mesh.element.size(); ++e) least = std::min(least, height_of(b.mesh, e) / speed);
  }
  return least;
}

double deepest(const std::vector<ContactPoint>& points) {
  double depth = 0;
  for (const ContactPoint& p : points) depth = std::max(depth, -p.gap);
  return depth;
}

void central_step(Parts& p, double h) {
  const System& s = p.system;
  Vector u = as_vector(p.state.u), a = as_vector(p.state.a);
  Vector half = as_vector(p.state.v) + 0.5 * h * a;
  const Vector before = u;
  u += h * half;
  p.state.time += h;
  s.fix(p.state.time, u);
  for (int i = 0; i < s.dofs; ++i)
    if (s.free[std::size_t(i)] < 0) half[i] = (u[i] - before[i]) / h;
  const Forces f = forces_at(s, u, half, 0, p.state.time, h, nullptr, &p.points);
  p.compliance_energy = f.compliance_energy;
  Vector v = half;
  for (int i = 0; i < s.dofs; ++i) {
    a[i] = s.free[std::size_t(i)] < 0 ? 0 : f.g[i] / s.lumped[i];
    v[i] += 0.5 * h * a[i];
  }
  assign(p.state.u, u);
  assign(p.state.v, v);
  assign(p.state.a, a);
}

void start(Parts& p) {
  const System& s = p.system;
  const Forces f = forces_at(s, as_vector(p.state.u), as_vector(p.state.v), 0, p.state.time, 0, nullptr, &p.points);
  for (int i = 0; i < s.dofs; ++i) p.state.a[std::size_t(i)] = s.free[std::size_t(i)] < 0 ? 0 : f.g[i] / s.lumped[i];
  p.lumped_mass = true;
  p.accelerated = false;  // of the lumped mass: Newmark's method starts anew
}

double bound_of(const CriticalStep& c) { return std::min(c.by_iteration, c.by_friction); }

}  // namespace

CriticalStep Simulation::critical_step() const {
  const System& s = parts_->system;
  s.need_density();
  const Vector u = as_vector(parts_->state.u), v = as_vector(parts_->state.v), mass = s.freed(s.lumped);
  Vector none = Vector::Zero(s.dofs);
  const auto tangent = [&](double rate) {
    Triplets t;
    s.contact.add({u, v, rate, parts_->state.time, 0}, none, &t, nullptr);
    return s.freed(t);
  };
  const Sparse stiff = tangent(0), braked = tangent(1);
  CriticalStep c;
  c.by_wave = wave_step(s.model);
  c.by_iteration = 2 / std::sqrt(largest_eigenvalue(s.free_stiffness + stiff, mass));
  c.by_friction = std::numeric_limits<double>::infinity();
  const Sparse brake = braked - stiff;
  if (brake.norm() > 0) c.by_friction = 2 / largest_eigenvalue(brake, mass);
  return c;
}

MarchReport Simulation::central_difference(const CentralSettings& settings) {
  Parts& p = *parts_;
  p.system.need_density();
  if (!(settings.step > 0)) throw InputError(line("step is %g s; it must be above 0", settings.step));
  const CriticalStep first = critical_step();
  if (settings.refuse_above_critical && settings.step > bound_of(first))
    throw InputError(
        line("step is %.4g s, above the critical one of central differences, %.4g s (elements %.4g s, "
             "friction %.4g s); take a shorter step or Newmark's method",
             settings.step, bound_of(first), first.by_iteration, first.by_friction));
  start(p);
  MarchReport report;
  double checked_depth = deepest(p.points);
  while (settings.end - p.state.time > 1e-9 * settings.step) {
    const double h = std::min(settings.step, settings.end - p.state.time);
    central_step(p, h);
    StepReport one{.time = p.state.time, .step = h, .accepted = true};
    for (const ContactPoint& q : p.points)
      ++(q.touch == Touch::open ? one.open : q.touch == Touch::stick ? one.stick : one.slip);
    report.step.push_back(one);
    if (settings.watch && !settings.watch(*this)) {
      report.reason = "ended by the watch";
      return report;
    }
    if (!settings.refuse_above_critical || deepest(p.points) <= 1.2 * checked_depth) continue;
    checked_depth = deepest(p.points);
    const double bound = bound_of(critical_step());
    if (settings.step <= bound) continue;
    report.reason = line("at %.6g s contact stiffened, and the step of %.4g s is above the critical one, %.4g s",
                         p.state.time, settings.step, bound);
    return report;
  }
  report.finished = true;
  return report;
}

}  // namespace gonogo::sim::elastic
