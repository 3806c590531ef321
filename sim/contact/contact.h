// One contact as the solver sees it.
#pragma once
#include "sim/contact/cone.h"
#include "sim/shape/shape.h"

namespace gonogo::sim {

using ContactIndex = Index;

/// Numbers of a contact, or of eight (T = Pack). All vectors are in the world frame.
template <class T>
struct ContactNumbers {
  Vec3T<T> normal;    // unit, from b to a
  T bias;             // [m/s]: gap / step, or a slower push-out where overlapping; the normal speed stays above -bias
  Vec3T<T> arm_a;     // from the centre of mass of a to the contact point [m]
  T mu;               // sliding friction [-]
  Vec3T<T> arm_b;     // [m]
  T rho;              // rolling resistance: coefficient times radius [m]
  ConeStepT<T> step;  // metric of the iteration, mass splitting included [kg, kg, kg m^2]
  T cohesion;         // largest tensile impulse in one step [N s]
};

/// Body a carries the sphere that found the contact.
struct alignas(16) Contact : ContactNumbers<Real> {
  BodyIndex body_a, body_b;
  WorldIndex world;
  Real unsplit;  // step times this is the metric without mass splitting, in which the residual is measured [-]
};

/// Impulse of a contact on body a (body b gets the opposite); padded to 32 bytes so that loads are aligned.
template <class T>
struct alignas(8 * sizeof(T)) ImpulseT {
  Vec3T<T> linear;  // at the contact point [N s]
  T pad0{};
  Vec3T<T> angular;  // rolling resistance [N m s]
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

/// Velocity of body a relative to body b at the contact point.
template <class T>
GONOGO_HD_INLINED Vec3T<T> contact_velocity(const ContactNumbers<T>& c, const VelocityT<T>& a, const VelocityT<T>& b) {
  return a.linear + cross(a.angular, c.arm_a) - b.linear - cross(b.angular, c.arm_b);
}

/// Gradient of the CCP at a contact: D^T v + b, linear [m/s] and turning [rad/s].
template <class T>
struct ContactGradient {
  Vec3T<T> linear, angular;
};

template <class T>
GONOGO_HD_INLINED ContactGradient<T> contact_gradient(const ContactNumbers<T>& c, const VelocityT<T>& a,
                                                      const VelocityT<T>& b) {
  return {contact_velocity(c, a, b) + c.normal * c.bias, a.angular - b.angular};
}

/// gamma - S g, projected onto the contact's cone: one projected-gradient update with step sizes S.
template <class T>
GONOGO_HD_INLINED ImpulseT<T> projected_step(const ContactNumbers<T>& c, const ImpulseT<T>& from,
                                             const ContactGradient<T>& g, const ConeStepT<T>& step) {
  const T g_n = dot(g.linear, c.normal), from_n = dot(from.linear, c.normal);
  ConeImpulseT<T> target;
  target.normal = from_n - step.n * g_n + c.cohesion;
  target.tangential = (from.linear - c.normal * from_n) - (g.linear - c.normal * g_n) * step.t;
  const Vec3T<T> turn = from.angular - g.angular * step.r;
  target.rolling = turn - c.normal * dot(turn, c.normal);
  const ConeImpulseT<T> p = project_onto_cone<T>(target, c.mu, c.rho, step);
  ImpulseT<T> result;
  result.linear = c.normal * (p.normal - c.cohesion) + p.tangential;
  result.angular = p.rolling;
  return result;
}

/// Square of a projected step divided by its step sizes: the speed that is still wrong at this contact [m^2/s^2]. A
/// turning speed becomes a speed at the grain's surface.
template <class T>
GONOGO_HD_INLINED T residual_square(const ContactNumbers<T>& c, const Vec3T<T>& change, const Vec3T<T>& turn,
                                    const ConeStepT<T>& step) {
  const T normal = dot(change, c.normal), inverse_t = constant<T>(1) / step.t, inverse_r = constant<T>(1) / step.r;
  const Vec3T<T> tangential = change - c.normal * normal;
  const T normal_speed = normal / step.n;
  const T turning = dot(turn, turn) * inverse_r * inverse_r * dot(c.arm_a, c.arm_a);
  return normal_speed * normal_speed + dot(tangential, tangential) * inverse_t * inverse_t + turning;
}

/// One accelerated update of a contact: the projected step from the extrapolated impulse, the next extrapolation, and
/// the gradient along the change, whose sum over a world tells when to restart.
template <class T>
struct ContactUpdate {
  ImpulseT<T> impulse, extrapolated;
  T progress;
  T residual_square;  // of the step from the extrapolated impulse, as a speed [m^2/s^2]
};

template <class T>
GONOGO_HD_INLINED ContactUpdate<T> accelerated_update(const ContactNumbers<T>& c, const VelocityT<T>& a,
                                                      const VelocityT<T>& b, const ImpulseT<T>& old,
                                                      const ImpulseT<T>& from, const T& beta) {
  const ContactGradient<T> gradient = contact_gradient(c, a, b);
  ContactUpdate<T> u;
  u.impulse = projected_step(c, from, gradient, c.step);
  const Vec3T<T> change = u.impulse.linear - old.linear, turn = u.impulse.angular - old.angular;
  u.progress = dot(gradient.linear, change) + dot(gradient.angular, turn);
  u.residual_square = residual_square(c, u.impulse.linear - from.linear, u.impulse.angular - from.angular, c.step);
  u.extrapolated.linear = u.impulse.linear + change * beta;
  u.extrapolated.angular = u.impulse.angular + turn * beta;
  return u;
}

}  // namespace gonogo::sim
