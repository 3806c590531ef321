// One contact as the solver sees it.
#pragma once
#include "sim/contact/cone.h"
#include "sim/shape/shape.h"

namespace gonogo::sim {

using ContactIndex = Index;

/// Body a carries the sphere that found the contact. All vectors are in the world frame.
struct alignas(16) Contact {
  Vec3 normal;    // unit, from b to a
  Real bias;      // [m/s]: the normal speed must not fall below -bias; gap / step, or slower push-out when overlapping
  Vec3 arm_a;     // from the centre of mass of a to the contact point [m]
  Real mu;        // sliding friction [-]
  Vec3 arm_b;     // [m]
  Real rho;       // rolling resistance: coefficient times radius [m]
  ConeStep step;  // metric of the iteration, mass splitting included [kg, kg, kg m^2]
  Real cohesion;  // largest tensile impulse in one step [N s]
  BodyIndex body_a, body_b;
  WorldIndex world;
  Real unsplit;  // step times this is the metric without mass splitting, in which the residual is measured [-]
};

/// Impulse of a contact on body a (body b gets the opposite); padded to 32 bytes so that loads are aligned.
struct alignas(16) Impulse {
  Vec3 linear;  // at the contact point [N s]
  Real pad0 = 0;
  Vec3 angular;  // rolling resistance [N m s]
  Real pad1 = 0;
};

/// Velocity of a body; both parts in the world frame.
struct alignas(16) Velocity {
  Vec3 linear;  // of the centre of mass [m/s]
  Real pad0 = 0;
  Vec3 angular;  // [rad/s]
  Real pad1 = 0;
};

/// Velocity of body a relative to body b at the contact point.
GONOGO_HD inline Vec3 contact_velocity(const Contact& c, const Velocity& a, const Velocity& b) {
  return a.linear + cross(a.angular, c.arm_a) - b.linear - cross(b.angular, c.arm_b);
}

/// Gradient of the CCP at a contact: D^T v + b, linear [m/s] and turning [rad/s].
struct ContactGradient {
  Vec3 linear, angular;
};

GONOGO_HD inline ContactGradient contact_gradient(const Contact& c, const Velocity& a, const Velocity& b) {
  return {contact_velocity(c, a, b) + c.normal * c.bias, c.rho > 0 ? a.angular - b.angular : Vec3{}};
}

/// gamma - S g, projected onto the contact's cone: one projected-gradient update with step sizes S.
GONOGO_HD inline Impulse projected_step(const Contact& c, const Impulse& from, const ContactGradient& g,
                                        const ConeStep& step) {
  const Real g_n = dot(g.linear, c.normal);
  const Real from_n = dot(from.linear, c.normal);
  ConeImpulse target;
  target.normal = from_n - step.n * g_n + c.cohesion;
  target.tangential = (from.linear - c.normal * from_n) - (g.linear - c.normal * g_n) * step.t;
  if (c.rho > 0) {
    const Vec3 wish = from.angular - g.angular * step.r;
    target.rolling = wish - c.normal * dot(wish, c.normal);
  }
  const ConeImpulse p = project_onto_cone(target, c.mu, c.rho, step);
  Impulse result;
  result.linear = c.normal * (p.normal - c.cohesion) + p.tangential;
  result.angular = p.rolling;
  return result;
}

}  // namespace gonogo::sim
