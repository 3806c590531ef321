// Control of one world's iteration: how far to extrapolate, when to restart, when to stop. Momentum follows Nesterov
// (1983), its restart O'Donoghue & Candes (2015, gradient scheme, eq. 13).
#pragma once
#include <string>
#include <vector>

#include "base/parallel/buffer.h"
#include "sim/law/contact_law.h"

namespace gonogo::sim {

/// The registry of iterations, by which complementarity is solved: a line for each, its name in files and options.
///   apgd          accelerated projected gradients
/// jacobi        projected gradients without momentum
/// gauss_seidel  contact by contact, in colours (split.h)
/// bb            projected gradients of spectral length (spectral.h)
/// jacobi_scan   the steps of jacobi, summed by segmented scans as in the first GPU solvers (jacobi_scan.h)
#define GONOGO_ITERATIONS(ITERATION) \
  ITERATION(apgd)                    \
  ITERATION(jacobi)                  \
  ITERATION(gauss_seidel)            \
  ITERATION(bb)                      \
  ITERATION(jacobi_scan)

#define GONOGO_ENUMERATOR(name) name,
enum class Iteration : std::int32_t { GONOGO_ITERATIONS(GONOGO_ENUMERATOR) };
#undef GONOGO_ENUMERATOR

/// Names in files, options and reports, in the order of the numbers.
const std::vector<std::string>& iteration_names();
const char* name_of(Iteration iteration);

/// A contact law and, for complementarity, its iteration. One name says both: that of the iteration or the penalty law.
struct ContactMethod {
  ContactLaw contact = ContactLaw::complementarity;
  Iteration iteration = Iteration::apgd;

  bool operator==(const ContactMethod&) const = default;
};
const std::vector<std::string>& method_names();
const char* name_of(const ContactMethod& method);
/// Throws InputError that lists the names.
ContactMethod method_named(const std::string& name);

struct IterationRules {
  Iteration iteration;
  Target target;
  Index max_iterations;
  Real tolerance;  // of the root-mean-square residual [m/s]; 0: never stop early
  Index substeps;  // of a step
};

/// State of a world's iteration in one step.
struct alignas(16) Momentum {
  Real t = 1;            // Nesterov's sequence
  Real beta = 0;         // share of their last change by which the present velocities are extrapolated
  Real next_beta = 0;    // the same of the next velocities
  Index updates = 0;     // so far
  Index substep = 0;     // of the step, counted from 0
  Index iterations = 0;  // updates in this substep so far
  std::int32_t done = 0;
  // Of the present update:
  std::int32_t begins = 0;      // it is the first of a substep other than the first
  std::int32_t ends = 0;        // it is the last of a substep other than the last
  std::int32_t test = 0;        // it sums its residual
  std::int32_t renew_slip = 0;  // it renews the sliding speeds (target `coulomb`)
};

/// Sums of one update over the contacts of a world.
struct UpdateSums {
  double uphill = 0;           // gradient times change [J]
  double residual_square = 0;  // [m^2/s^2], where the update tests
};

/// Nesterov's t at the first update. A warm start is close to the solution, so momentum starts as after a few
/// iterations; the restart corrects it if that is too much. On a driven wheel at 10 iterations the residual is a third
/// lower than from t = 1.
inline constexpr Real kFirstMomentum = 4;

/// Max t that a substep takes over from the one before. The impulses of a driven wheel keep changing the same way for
/// many substeps, and a few updates in each give the restart no chance to limit momentum.
inline constexpr Real kCarriedMomentum = 3;

/// Every so many updates one sums its residual and renews the sliding speeds of the `coulomb` target.
inline constexpr Index kTestEvery = 5;

GONOGO_HD inline void extend_momentum(Momentum& m, const IterationRules& rules) {
  GONOGO_ASSERT(!(m.t < 1));
  const Real next = (1 + std::sqrt(1 + 4 * m.t * m.t)) / 2;
  m.next_beta = rules.iteration == Iteration::apgd ? (m.t - 1) / next : Real(0);
  m.t = next;
  GONOGO_ASSERT(!(m.next_beta < 0 || m.next_beta >= 1));
}

/// Plans the update that follows number m.iterations, counted from 0.
GONOGO_HD inline void plan_update(Momentum& m, const IterationRules& rules) {
  const bool fifth = m.iterations % kTestEvery == kTestEvery - 1;
  m.test = rules.tolerance > 0 && fifth;
  m.renew_slip = rules.target == Target::coulomb && (fifth || m.iterations == 0);
}

GONOGO_HD inline bool is_last_substep(const Momentum& m, const IterationRules& rules) {
  return m.substep + 1 == rules.substeps;
}

GONOGO_HD inline Momentum first_momentum(const IterationRules& rules) {
  GONOGO_ASSERT(rules.max_iterations >= 1 && rules.substeps >= 1 && rules.tolerance >= 0);
  Momentum m;
  m.t = kFirstMomentum;
  m.ends = rules.max_iterations == 1 && !is_last_substep(m, rules);
  extend_momentum(m, rules);
  plan_update(m, rules);
  return m;
}

/// Which substep the next update belongs to, and whether it ends it. Bodies must know beforehand which update ends a
/// substep that another follows, so a world that has converged makes one more update.
GONOGO_HD inline void plan_substep(Momentum& m, bool converged, const IterationRules& rules) {
  GONOGO_ASSERT(m.substep < rules.substeps && m.iterations <= rules.max_iterations);
  m.begins = m.ends;
  if (m.ends) {
    ++m.substep;
    m.iterations = 0;
    converged = false;
  }
  m.ends = !is_last_substep(m, rules) && (converged || m.iterations + 1 >= rules.max_iterations);
  m.done = is_last_substep(m, rules) && (converged || m.iterations >= rules.max_iterations);
}

/// Moves on to the next update. An update that went uphill resets momentum one update late, because its sums are known
/// only after the next velocities.
GONOGO_HD inline void decide_next_update(Momentum& m, const UpdateSums& sums, Index contacts,
                                         const IterationRules& rules) {
  GONOGO_ASSERT(!m.done && contacts >= 0 && !(sums.residual_square < 0));
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
