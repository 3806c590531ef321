// One implicit step: its equations, and their solution by Newton-Raphson with a line search. Internal: Eigen.
#pragma once
#include "sim/elastic/system.h"

namespace gonogo::sim::elastic {

/// Unknown: displacements u at the end of the step. Velocity v = rate u + v_rest and acceleration a = inertia u +
/// a_rest are linear in it. Equations on free degrees of freedom, with g(u, v) = loads - K u + contact:
///   (1 + alpha) g(u, v) - alpha g_before - M a = 0
struct ImplicitStep {
  const System& system;
  double time = 0, step = 0;  // at the end; length [s]
  double rate = 0, inertia = 0, alpha = 0;
  Vector v_rest{}, a_rest{}, g_before{};  // [dof]; a_rest counts where inertia is above 0

  Vector velocity(const Vector& u) const { return rate * u + v_rest; }
  Vector acceleration(const Vector& u) const { return inertia * u + a_rest; }
};

/// g(u, v) and what it is made of.
struct Forces {
  Vector g;          // [dof] [N]
  double scale = 0;  // norm of the largest part [N]
  double compliance_energy = 0;
};
Forces forces_at(const System& system, const Vector& u, const Vector& v, double rate, double time, double step,
                 Triplets* tangent, std::vector<ContactPoint>* points);

struct NewtonResult {
  bool converged = false;
  std::string reason;
  Vector u;
  std::vector<ContactPoint> points;
  double compliance_energy = 0;
};

/// `u`: first guess with the fixed displacements of the step's end. Fills the report's iterations, halvings, residuals.
NewtonResult solve_step(const ImplicitStep& step, Vector u, const NewtonSettings& settings, StepReport& report);

}  // namespace gonogo::sim::elastic
