// What an iteration decides for one world: how far to extrapolate, when to start again, when to stop. Momentum and its
// restart follow Nesterov 1983 and O'Donoghue & Candes 2015 (gradient scheme, eq. 13).
#pragma once
#include "base/view.h"
#include "sim/state/target.h"

namespace gonogo::sim {

/// `apgd`: accelerated projected gradients; `jacobi`: plain ones; `gauss_seidel`: contact by contact, in colours
/// (colour.h); `bb`: projected gradients of spectral length (spectral.h); `jacobi_scan`: the steps of `jacobi`, added
/// up by segmented scans as the first solvers on GPUs did (jacobi_scan.h).
enum class Solver : std::int32_t { apgd, jacobi, gauss_seidel, bb, jacobi_scan };

struct IterationRules {
  Solver solver;
  Target target;
  Index max_iterations;
  Real tolerance;  // of the root-mean-square residual [m/s]; 0: never stop early
  Index substeps;  // of a step
};

/// State of a world's iteration in one step.
struct alignas(16) Momentum {
  Real t = 1;            // Nesterov's sequence
  Real beta = 0;         // the present velocities were extrapolated by this share of their last change
  Real next_beta = 0;    // and the next ones will be by this
  Index updates = 0;     // so far
  Index substep = 0;     // of the step, counted from 0
  Index iterations = 0;  // updates in this part so far
  std::int32_t done = 0;
  std::int32_t begins = 0;      // the present update is the first of a part that follows another
  std::int32_t ends = 0;        // the present update is the last of a part that another follows
  std::int32_t test = 0;        // the present update sums its residual
  std::int32_t renew_slip = 0;  // the present update takes the sliding speeds anew (target `coulomb`)
};

/// Sums of one update over the contacts of a world.
struct UpdateSums {
  double uphill = 0;           // gradient times change [J]
  double residual_square = 0;  // [m^2/s^2], where the update tests
};

/// The warm start is close to the solution, so momentum starts as it would stand after a few iterations; the restart
/// takes it back where that is too bold. Measured on a driven wheel at 10 iterations: a third less residual than from t
/// = 1.
inline constexpr Real kFirstMomentum = 4;

/// At most so much momentum goes on from a part of a step to the next: the impulses of a driven wheel keep changing the
/// same way for many parts, but with few updates in each nothing would hold momentum back.
inline constexpr Real kCarriedMomentum = 3;

/// Updates that sum their residual, and updates that renew the sliding speeds of the `coulomb` target, come after so
/// many others.
inline constexpr Index kTestEvery = 5;

GONOGO_HD inline void extend_momentum(Momentum& m, const IterationRules& rules) {
  const Real next = (1 + std::sqrt(1 + 4 * m.t * m.t)) / 2;
  m.next_beta = rules.solver == Solver::apgd ? (m.t - 1) / next : Real(0);
  m.t = next;
}

/// What the update before the next one does; the update just made is number m.iterations, counted from 0.
GONOGO_HD inline void plan_update(Momentum& m, const IterationRules& rules) {
  const bool fifth = m.iterations % kTestEvery == kTestEvery - 1;
  m.test = rules.tolerance > 0 && fifth;
  m.renew_slip = rules.target == Target::coulomb && (fifth || m.iterations == 0);
}

GONOGO_HD inline bool is_last_substep(const Momentum& m, const IterationRules& rules) {
  return m.substep + 1 == rules.substeps;
}

GONOGO_HD inline Momentum first_momentum(const IterationRules& rules) {
  Momentum m;
  m.t = kFirstMomentum;
  m.ends = rules.max_iterations == 1 && !is_last_substep(m, rules);
  extend_momentum(m, rules);
  plan_update(m, rules);
  return m;
}

/// Which part of the step the next update belongs to, and whether it ends that part. Bodies must know beforehand which
/// update is the last of a part that another follows; a world that has converged makes one more.
GONOGO_HD inline void plan_substep(Momentum& m, bool converged, const IterationRules& rules) {
  m.begins = m.ends;
  if (m.ends) {
    ++m.substep;
    m.iterations = 0;
    converged = false;
  }
  m.ends = !is_last_substep(m, rules) && (converged || m.iterations + 1 >= rules.max_iterations);
  m.done = is_last_substep(m, rules) && (converged || m.iterations >= rules.max_iterations);
}

/// From the sums of the present update to the state of the next. An update that went uphill ends the momentum of the
/// velocities after the next: its sums come too late for those in between.
GONOGO_HD inline void decide_next_update(Momentum& m, const UpdateSums& sums, Index contacts,
                                         const IterationRules& rules) {
  const double limit = double(rules.tolerance) * rules.tolerance * contacts;
  ++m.updates;
  ++m.iterations;
  plan_substep(m, m.test != 0 && sums.residual_square <= limit, rules);
  m.beta = m.next_beta;
  if (sums.uphill > 0) m.t = 1;
  if (m.begins) m.t = std::fmin(m.t, kCarriedMomentum);
  extend_momentum(m, rules);
  plan_update(m, rules);
}

}  // namespace gonogo::sim
