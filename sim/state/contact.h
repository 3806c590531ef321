// One contact as the solvers see it: projection onto the cone of admissible impulses, and the formulas of one
// projected-gradient update. The cone is
//   K = { (n, t, r, s) : n >= 0, |t| <= mu n, |r| <= rho n, |s| <= sigma n }
// n: normal impulse [N s]; t: friction impulse in the tangent plane [N s]; r: rolling-resistance impulse in the tangent
// plane [N m s]; s: spinning-resistance impulse about the normal [N m s]; mu: friction coefficient [-]; rho, sigma:
// rolling and spinning resistance [m]. Cohesion shifts the apex and is handled by the caller. T is Real, or Pack for
// eight contacts at once.
#pragma once
#include "base/math/pack.h"
#include "sim/shape/shape.h"

namespace gonogo::sim {

template <class T>
struct ConeImpulseT {
  T normal{};
  Vec3T<T> tangential, rolling;
  T spinning{};
};

/// Opening of the cone.
template <class T>
struct ConeShapeT {
  T mu, rho, sigma;
};

/// Inverse metric of the projection, one positive step per component: minimises
///   (n - n0)^2 / step.n + |t - t0|^2 / step.t + (|r - r0|^2 + (s - s0)^2) / step.r   over K.
template <class T>
struct ConeStepT {
  T n, t, r;
};

using ConeImpulse = ConeImpulseT<Real>;
using ConeShape = ConeShapeT<Real>;
using ConeStep = ConeStepT<Real>;

template <class T>
GONOGO_HD_INLINED T magnitude(const T& x) {
  return select(x < constant<T>(0), -x, x);
}

/// A friction part of this size, cut to the limit.
template <class V, class T>
GONOGO_HD_INLINED V clipped(const V& part, const T& size, const T& limit) {
  return part * select(size > limit, quick_ratio(limit, size), constant<T>(1));
}

/// Nearest point of K. For a given n every friction part is clipped to its radius, so what is left is to minimise a
/// convex, piecewise quadratic function of n. Its derivative rises and is concave: Newton's method climbs from n0 to
/// the root without passing it, in at most one pass per clipped part. The eight contacts of a Pack may lie on different
/// pieces; passes end when none of them moves. `turning`: rolling and spinning parts exist.
template <bool turning, class T>
GONOGO_HD_INLINED ConeImpulseT<T> project_onto_cone(const ConeImpulseT<T>& p, const ConeShapeT<T>& cone,
                                                    const ConeStepT<T>& step) {
  const T zero = constant<T>(0);
  const T slide = quick_root(dot(p.tangential, p.tangential));
  T roll{}, spin{};
  // Weights of the parts, multiplied by the steps of all, so that each pass divides once.
  T normal_weight = step.t, slide_weight = cone.mu * step.n, roll_weight{}, spin_weight{};
  if constexpr (turning) {
    roll = quick_root(dot(p.rolling, p.rolling));
    spin = magnitude(p.spinning);
    roll_weight = cone.rho * step.n * step.t;
    spin_weight = cone.sigma * step.n * step.t;
    normal_weight = step.t * step.r;
    slide_weight = slide_weight * step.r;
  }
  T n = p.normal;
  for (int pass = 0; pass < (turning ? 3 : 1); ++pass) {
    const T slides = select(slide > cone.mu * n, slide_weight, zero);
    T sum = normal_weight * p.normal + slides * slide, weight = normal_weight + slides * cone.mu;
    if constexpr (turning) {
      const T rolls = select(roll > cone.rho * n, roll_weight, zero);
      const T spins = select(spin > cone.sigma * n, spin_weight, zero);
      sum += rolls * roll + spins * spin;
      weight += rolls * cone.rho + spins * cone.sigma;
    }
    const T next = select(sum == normal_weight * p.normal, p.normal, quick_ratio(sum, weight));
    if (no_lane(next != n)) break;
    n = next;
  }
  n = select(n > zero, n, zero);
  const Vec3T<T> sliding = clipped(p.tangential, slide, cone.mu * n);
  if constexpr (!turning) return {n, sliding, Vec3T<T>{}, zero};
  return {n, sliding, clipped(p.rolling, roll, cone.rho * n), clipped(p.spinning, spin, cone.sigma * n)};
}

GONOGO_HD inline ConeImpulse project_onto_cone(const ConeImpulse& p, const ConeShape& cone, const ConeStep& step) {
  GONOGO_ASSERT(cone.mu >= 0 && cone.rho >= 0 && cone.sigma >= 0);
  GONOGO_ASSERT(step.n > 0 && step.t > 0 && step.r > 0);
  return project_onto_cone<true, Real>(p, cone, step);
}

using ContactIndex = Index;

/// Numbers of one contact (T = Real) or of a block of eight (T = Pack). Vectors are in the world frame.
template <class T>
struct ContactNumbers {
  Vec3T<T> normal;    // unit, from b to a
  T bias;             // [m/s]; the normal speed stays above -bias, see bias_of_gap
  Vec3T<T> arm_a;     // from the centre of mass of a to the contact point [m]
  T mu;               // sliding friction [-]
  Vec3T<T> arm_b;     // [m]
  T rho;              // rolling resistance: coefficient times radius [m]
  ConeStepT<T> step;  // metric of the iteration, mass splitting included [kg, kg, kg m^2]
  T cohesion;         // largest tensile impulse in one step [N s]
  T sigma;            // spinning resistance: coefficient times radius [m]
  T softness;         // normal speed per normal impulse that a compliant contact gives way by; 0: rigid [1/kg]
};

/// Body a carries the shape that found the contact.
struct alignas(16) Contact : ContactNumbers<Real> {
  BodyIndex body_a, body_b;
  Real unsplit;   // step * unsplit: the metric without mass splitting, in which the residual is measured [-]
  Real gap_bias;  // bias without the term of the `coulomb` target [m/s]
  WorldIndex world;
  Real gap;       // at the start of the substep; of a contact with give, what counts of it, see counted_gap [m]
  Real gap_rate;  // bias per metre of an open gap, or of any gap of a compliant contact or one with give [1/s]
};

/// Impulse of a contact on body a (body b gets the opposite); padded to 32 bytes so that loads are aligned.
template <class T>
struct alignas(8 * sizeof(T)) ImpulseT {
  Vec3T<T> linear;  // at the contact point [N s]
  T pad0{};
  Vec3T<T> angular;  // rolling and spinning resistance [N m s]
  T pad1{};
};

/// Velocity of a body; both parts in the world frame.
template <class T>
struct alignas(8 * sizeof(T)) VelocityT {
  Vec3T<T> linear;  // of the centre of mass [m/s]
  T pad0{};
  Vec3T<T> angular;  // [rad/s]
  T pad1{};
};

using Impulse = ImpulseT<Real>;
using Velocity = VelocityT<Real>;

/// For assertions: whether an impulse lies in the cone of its contact, within rounding: that of its own size, and that
/// of the terms that cancelled in it, which change the contact's speed by 1e-6 m/s at most. NaN passes.
GONOGO_HD inline bool is_in_cone(const ContactNumbers<Real>& c, const Impulse& p) {
  const Real along = dot(p.linear, c.normal), n = along + c.cohesion, spin = dot(p.angular, c.normal);
  const Real slide = length(p.linear - c.normal * along), roll = length(p.angular - c.normal * spin);
  const Real slack = Real(1e-3) * (std::fabs(along) + c.cohesion) + Real(1e-6) * c.step.n;
  return !(n < -slack) && !(slide > c.mu * (n + slack) + slack) && !(roll > c.rho * (n + slack) + slack) &&
         !(std::fabs(spin) > c.sigma * (n + slack) + slack);
}

/// A contact's weight when a body shares its mass among its contacts (split.h): loaded contacts get more.
GONOGO_HD inline Index contact_weight(const Contact& c, const Impulse& start) {
  return dot(start.linear, c.normal) > 0 || c.gap < 0 ? 4 : 1;
}

GONOGO_HD_INLINED Velocity sum(const Velocity& a, const Velocity& b) {
  return {a.linear + b.linear, 0, a.angular + b.angular, 0};
}
GONOGO_HD_INLINED Velocity difference(const Velocity& a, const Velocity& b) {
  return {a.linear - b.linear, 0, a.angular - b.angular, 0};
}

template <class T>
GONOGO_HD_INLINED VelocityT<T> extrapolated(const VelocityT<T>& now, const VelocityT<T>& before, const T& beta) {
  return {.linear = multiply_add(now.linear - before.linear, beta, now.linear),
          .angular = multiply_add(now.angular - before.angular, beta, now.angular)};
}

template <class T>
GONOGO_HD_INLINED ImpulseT<T> extrapolated(const ImpulseT<T>& now, const ImpulseT<T>& before, const T& beta) {
  return {.linear = multiply_add(now.linear - before.linear, beta, now.linear),
          .angular = multiply_add(now.angular - before.angular, beta, now.angular)};
}

/// Velocity of body a relative to body b at the contact point.
template <class T>
GONOGO_HD_INLINED Vec3T<T> contact_velocity(const ContactNumbers<T>& c, const VelocityT<T>& a, const VelocityT<T>& b) {
  return cross_add(a.angular, c.arm_a, cross_add(c.arm_b, b.angular, a.linear - b.linear));
}

/// Speed along the tangent plane [m/s].
template <class T>
GONOGO_HD_INLINED T slip_speed(const ContactNumbers<T>& c, const VelocityT<T>& a, const VelocityT<T>& b) {
  const Vec3T<T> u = contact_velocity(c, a, b);
  const Vec3T<T> tangential = multiply_add(c.normal, -dot(u, c.normal), u);
  return square_root(dot(tangential, tangential));
}

/// De Saxce's term mu |u_t| + rho |w_t| + sigma |w_n| [m/s]: the normal speed at which the convex relaxation lets a
/// sliding, rolling or spinning contact open.
template <bool turning, class T>
GONOGO_HD_INLINED T opening_speed(const ContactNumbers<T>& c, const VelocityT<T>& a, const VelocityT<T>& b) {
  T speed = c.mu * slip_speed(c, a, b);
  if constexpr (turning) {
    const Vec3T<T> turn = a.angular - b.angular;
    const T spin = dot(turn, c.normal);
    const Vec3T<T> roll = multiply_add(c.normal, -spin, turn);
    speed += c.rho * square_root(dot(roll, roll)) + c.sigma * magnitude(spin);
  }
  return speed;
}

/// Gradient of the CCP at a contact: D^T v + b + E gamma, linear [m/s] and turning [rad/s].
template <class T>
struct ContactGradient {
  Vec3T<T> linear, angular;
};

template <class T>
GONOGO_HD_INLINED ContactGradient<T> contact_gradient(const ContactNumbers<T>& c, const VelocityT<T>& a,
                                                      const VelocityT<T>& b, const ImpulseT<T>& p) {
  const T resting = multiply_add(c.softness, dot(p.linear, c.normal), c.bias);
  return {multiply_add(c.normal, resting, contact_velocity(c, a, b)), a.angular - b.angular};
}

/// P_K(gamma - S g): one projected-gradient update with step sizes S. `turning`: some contact resists rolling or
/// spinning.
template <bool turning, class T>
GONOGO_HD_INLINED ImpulseT<T> projected_step(const ContactNumbers<T>& c, const ImpulseT<T>& from,
                                             const ContactGradient<T>& g, const ConeStepT<T>& step) {
  const T g_n = dot(g.linear, c.normal), from_n = dot(from.linear, c.normal);
  ConeImpulseT<T> target;
  target.normal = multiply_add(-step.n, g_n, from_n) + c.cohesion;
  const Vec3T<T> moved = multiply_add(g.linear, -step.t, from.linear);
  target.tangential = multiply_add(c.normal, multiply_add(step.t, g_n, -from_n), moved);
  if constexpr (turning) {
    const Vec3T<T> turn = multiply_add(g.angular, -step.r, from.angular);
    target.spinning = dot(turn, c.normal);
    target.rolling = multiply_add(c.normal, -target.spinning, turn);
  }
  const ConeImpulseT<T> p = project_onto_cone<turning, T>(target, {c.mu, c.rho, c.sigma}, step);
  ImpulseT<T> result;
  result.linear = multiply_add(c.normal, p.normal - c.cohesion, p.tangential);
  if constexpr (turning) result.angular = multiply_add(c.normal, p.spinning, p.rolling);
  return result;
}

/// Square of a projected step divided by its step sizes: the square of the speed that is still wrong [m^2/s^2].
/// Turning speeds are converted by the lever sqrt(step.r / step.t), about the radius of the lighter grain.
template <bool turning, class T>
GONOGO_HD_INLINED T residual_square(const ContactNumbers<T>& c, const ImpulseT<T>& next, const ImpulseT<T>& from,
                                    const ConeStepT<T>& step) {
  const Vec3T<T> change = next.linear - from.linear;
  const T normal = dot(change, c.normal), inverse_t = constant<T>(1) / step.t;
  const Vec3T<T> tangential = change - c.normal * normal;
  const T normal_speed = normal / step.n;
  T sum = normal_speed * normal_speed + dot(tangential, tangential) * inverse_t * inverse_t;
  if constexpr (turning) {
    const Vec3T<T> turn = next.angular - from.angular;
    sum += dot(turn, turn) * inverse_t / step.r;
  }
  return sum;
}

/// One accelerated update of a contact: the projected step from the extrapolated impulse, and the gradient along the
/// change. The sum of the latter over a world tells when to restart momentum.
template <class T>
struct ContactUpdate {
  ImpulseT<T> from, impulse;  // extrapolated; projected
  T uphill;                   // gradient times change [J]
};

/// `a`, `b`: extrapolated velocities; `now`, `before`: the latest two impulses.
template <bool turning, class T>
GONOGO_HD_INLINED ContactUpdate<T> accelerated_update(const ContactNumbers<T>& c, const VelocityT<T>& a,
                                                      const VelocityT<T>& b, const ImpulseT<T>& now,
                                                      const ImpulseT<T>& before, const T& beta) {
  const ImpulseT<T> from = extrapolated(now, before, beta);
  const ContactGradient<T> gradient = contact_gradient(c, a, b, from);
  const ImpulseT<T> impulse = projected_step<turning>(c, from, gradient, c.step);
  T uphill = dot(gradient.linear, impulse.linear - now.linear);
  if constexpr (turning) uphill += dot(gradient.angular, impulse.angular - now.angular);
  return {from, impulse, uphill};
}

/// Square of the speed that this update corrected [m^2/s^2].
template <bool turning, class T>
GONOGO_HD_INLINED T residual_square(const ContactNumbers<T>& c, const ContactUpdate<T>& u) {
  return residual_square<turning>(c, u.impulse, u.from, c.step);
}

/// Impulse of a contact on a body and its moment about the centre of mass.
struct alignas(32) Wrench {
  Vec3 linear;  // [N s]
  Real pad0 = 0;
  Vec3 angular;  // [N m s]
  Real pad1 = 0;
};

GONOGO_HD_INLINED Vec3 moment(const Vec3& arm, const Impulse& p) { return cross_add(arm, p.linear, p.angular); }

}  // namespace gonogo::sim
