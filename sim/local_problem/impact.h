// Impacts one contact after another, with restitution: the impulse family of contact solvers.
//
// The contact that approaches fastest is struck, its neighbours feel it, until none approaches any more. A strike obeys
// Coulomb's law for the impulse that it adds (one_contact.h), and
//   newton   u_n after = -e u_n before
//   poisson  r_n = (1 + e) times the impulse that ends the compression, u_n = 0; friction acts in both phases
// An approach slower than `resting_speed` is struck with e = 0: contacts at rest are held by micro-impulses (Mirtich &
// Canny 1995). Chains of strikes carry momentum as chains of balls do, which a law for all contacts at once does not.
#pragma once
#include "sim/local_problem/problem.h"

namespace gonogo::sim {

enum class ImpactLaw { newton, poisson };

struct ImpactSettings {
  ImpactLaw law = ImpactLaw::newton;
  double restitution = 0;    // e, 0 .. 1
  double resting_speed = 0;  // [unit of q]
  double tolerance = 1e-9;   // approach speed that counts as none [unit of q]
  int max_strikes = 1000000;
};

struct ImpactResult {
  std::vector<double> r;   // sum of the impulses [contact_count * dimension]
  std::vector<double> u;   // velocities after the last strike
  double energy_gain = 0;  // kinetic energy after less before; sum of r . (u before + u after) / 2 over the strikes
  int strikes = 0;
  bool ended = false;  // no contact approaches faster than the tolerance
};

/// Throws InputError for a problem with rolling friction and for settings out of range.
ImpactResult sequential_impacts(const LocalProblem& problem, const ImpactSettings& settings);

}  // namespace gonogo::sim
