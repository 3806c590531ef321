// What an iteration decides for one world: how far to extrapolate, when to start again, when to stop. Momentum and its
// restart follow Nesterov 1983 and O'Donoghue & Candes 2015 (gradient scheme, eq. 13).
#pragma once
#include "base/view.h"

namespace gonogo::sim {

enum class Solver : std::int32_t { apgd, jacobi };

/// What a solution satisfies: the convex relaxation of Anitescu, in which a sliding contact opens at mu |v_t|, or
/// Coulomb's law, reached by iterating on that term (De Saxce & Feng 1998).
enum class Target : std::int32_t { ccp, coulomb };

struct IterationRules {
  Solver solver;
  Target target;
  Index most_iterations;
  Real tolerance;  // of the root-mean-square residual [m/s]; 0: never stop early
};

/// State of a world's iteration in one step.
struct Momentum {
  Real t = 1;     // Nesterov's sequence
  Real beta = 0;  // the next extrapolation goes this share of the last change further
  Index iterations = 0;
  std::int32_t done = 0;
  std::int32_t renew_slip = 0;  // the next update takes the sliding speeds anew (target `coulomb`)
};

/// Sums of one update over the contacts of a world.
struct UpdateSums {
  double uphill = 0;           // gradient times change [J]
  double residual_square = 0;  // [m^2/s^2]
};

/// The warm start is close to the solution, so momentum starts as it would stand after a few iterations; the restart
/// takes it back where that is too bold. Measured on a driven wheel at 10 iterations: a third less residual than from t
/// = 1.
inline constexpr Real kFirstMomentum = 4;

/// The `coulomb` target renews its sliding speeds after every so many iterations.
inline constexpr Index kRenewSlipEvery = 5;

/// After an update that went uphill the momentum starts again from nothing.
GONOGO_HD inline void decide_next_update(Momentum& m, const UpdateSums& sums, Index contacts,
                                         const IterationRules& rules) {
  ++m.iterations;
  const bool exact_target = rules.target == Target::ccp || m.renew_slip != 0;
  const double limit = double(rules.tolerance) * rules.tolerance * contacts;
  m.done = m.iterations >= rules.most_iterations ||
           (rules.tolerance > 0 && exact_target && sums.residual_square <= limit);
  m.renew_slip = rules.target == Target::coulomb && m.iterations % kRenewSlipEvery == 0;
  if (rules.solver == Solver::jacobi) return;
  if (sums.uphill > 0) m.t = 1;
  const Real next = (1 + std::sqrt(1 + 4 * m.t * m.t)) / 2;
  m.beta = (m.t - 1) / next;
  m.t = next;
}

GONOGO_HD inline Momentum first_momentum(const IterationRules& rules) {
  Momentum m;
  m.t = kFirstMomentum;
  m.renew_slip = rules.target == Target::coulomb;
  return m;
}

}  // namespace gonogo::sim
