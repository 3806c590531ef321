// The spectral projected gradient method (`bb`). The length of a step follows from the change of the gradient along the
// step before (Barzilai & Borwein 1988; projected: Birgin, Martinez, Raydan 2000). The unit of length is the step of
// mass splitting, which never overshoots, so there is no line search. When the objective rises above its running mean
// (Zhang & Hager 2004), steps have length one until it is below. A length serves one update late, because its sums are
// known at the end of an update (gradient method with retards, Friedlander et al. 1999). Lengths are capped, see
// kMaxStep.
#pragma once
#include "sim/state/contact.h"
#include "sim/state/iteration.h"

namespace gonogo::sim {

/// Longest step, in steps of mass splitting. With 10, impacts between grains end up to seventeen times above the
/// residual that they reach with 4; with 30 they blow up.
inline constexpr double kMaxStep = 4;
/// Weight of the past in the objective's running mean.
inline constexpr double kMemory = 0.85;

/// Differences between an iterate and the one before, summed over the contacts of a world. s: change of the impulses;
/// y: change of the gradient; S: step sizes of mass splitting.
template <class T>
struct SpectralSumsT {
  T change_square{};  // s . S^-1 s [J]
  T curvature{};      // s . y [J]
  T rise{};           // of the objective [J]
};
using SpectralSums = SpectralSumsT<double>;

GONOGO_HD inline SpectralSums& operator+=(SpectralSums& a, const SpectralSums& b) {
  a.change_square += b.change_square;
  a.curvature += b.curvature;
  a.rise += b.rise;
  return a;
}

/// State of a world's iteration in one step.
struct alignas(16) SpectralStep {
  double length = 1;  // of the present update
  double objective = 0, mean = 0, weight = 1;
};

/// Length of the next update from the sums of update number `m.updates`. `m`: before the update is counted; `next`:
/// after.
GONOGO_HD inline void decide_next_length(SpectralStep& step, const SpectralSums& sums, const Momentum& m,
                                         const Momentum& next, const IterationRules& rules) {
  GONOGO_ASSERT(step.weight >= 1 && rules.max_iterations >= 1);
  const bool first = m.iterations == 0;  // of a substep: the iterate before belongs to another objective
  if (first) {
    step.objective = step.mean = 0;
    step.weight = 1;
  }
  bool rose = false;
  if (!first && sums.curvature > 0) {
    step.objective += sums.rise;
    rose = step.objective > step.mean;
    step.mean = (kMemory * step.weight * step.mean + step.objective) / (kMemory * step.weight + 1);
    step.weight = kMemory * step.weight + 1;
    step.length = std::fmin(std::fmax(sums.change_square / sums.curvature, 1.0), kMaxStep);
  }
  // A test measures the step of length one, and so does the last update, so that it leaves no overshoot.
  const bool last = next.iterations + 1 >= rules.max_iterations;
  if (rose || last || next.test != 0 || !(step.length >= 1)) step.length = 1;
}

/// One update, and the sums of the iterate that it starts from.
template <class T>
struct SpectralUpdate {
  ContactUpdate<T> update;
  SpectralSumsT<T> sums;
};

template <bool turning, class T>
GONOGO_HD_INLINED SpectralSumsT<T> spectral_sums(const ContactNumbers<T>& c, const ContactGradient<T>& now,
                                                 const ContactGradient<T>& before, const ImpulseT<T>& p,
                                                 const ImpulseT<T>& p0) {
  const Vec3T<T> s = p.linear - p0.linear, y = now.linear - before.linear;
  const T s_n = dot(s, c.normal);
  const Vec3T<T> s_t = s - c.normal * s_n;
  SpectralSumsT<T> sums;
  sums.change_square = s_n * s_n / c.step.n + dot(s_t, s_t) / c.step.t;
  sums.curvature = dot(s, y);
  T slope = dot(s, now.linear);
  if constexpr (turning) {
    const Vec3T<T> turn = p.angular - p0.angular, turned = now.angular - before.angular;
    sums.change_square += dot(turn, turn) / c.step.r;
    sums.curvature += dot(turn, turned);
    slope += dot(turn, now.angular);
  }
  sums.rise = slope - constant<T>(Real(0.5)) * sums.curvature;
  return sums;
}

template <bool turning, class T>
GONOGO_HD_INLINED SpectralUpdate<T> spectral_update(const ContactNumbers<T>& c, const VelocityT<T>& a,
                                                    const VelocityT<T>& b, const VelocityT<T>& a0,
                                                    const VelocityT<T>& b0, const ImpulseT<T>& now,
                                                    const ImpulseT<T>& before, const T& length) {
  const ContactGradient<T> gradient = contact_gradient(c, a, b, now);
  SpectralUpdate<T> u;
  u.sums = spectral_sums<turning, T>(c, gradient, contact_gradient(c, a0, b0, before), now, before);
  u.update.from = now;
  const ConeStepT<T> step{c.step.n * length, c.step.t * length, c.step.r * length};
  u.update.impulse = projected_step<turning, T>(c, now, gradient, step);
  return u;
}

}  // namespace gonogo::sim
