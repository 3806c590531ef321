#include "sim/elastic/newton.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <limits>

namespace gonogo::sim::elastic {
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
