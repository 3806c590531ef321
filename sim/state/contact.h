// One contact as the solvers see it, and the formulas of one projected-gradient update.
#pragma once
#include "sim/shape/shape.h"
#include "sim/state/cone.h"

namespace gonogo::sim {

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
  Real gap;       // at the start of the substep [m]
  Real gap_rate;  // bias per metre of an open gap, or of any gap of a compliant contact [1/s]
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
  VelocityT<T> v;
  v.linear = multiply_add(now.linear - before.linear, beta, now.linear);
  v.angular = multiply_add(now.angular - before.angular, beta, now.angular);
  return v;
}

template <class T>
GONOGO_HD_INLINED ImpulseT<T> extrapolated(const ImpulseT<T>& now, const ImpulseT<T>& before, const T& beta) {
  ImpulseT<T> p;
  p.linear = multiply_add(now.linear - before.linear, beta, now.linear);
  p.angular = multiply_add(now.angular - before.angular, beta, now.angular);
  return p;
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
  ContactUpdate<T> u;
  u.from = extrapolated(now, before, beta);
  const ContactGradient<T> gradient = contact_gradient(c, a, b, u.from);
  u.impulse = projected_step<turning>(c, u.from, gradient, c.step);
  u.uphill = dot(gradient.linear, u.impulse.linear - now.linear);
  if constexpr (turning) u.uphill += dot(gradient.angular, u.impulse.angular - now.angular);
  return u;
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
