// Explicit forces on bodies, computed at the beginning of a step: constant or ramped loads, and aerodynamic drag.
// Springs and dampers are implicit, see mechanism.h.
#pragma once
#include "sim/state/contact.h"

namespace gonogo::sim {

/// Axes in which a vector is given.
enum class ReferenceFrame : std::int32_t { world, body };

enum class ForceType : std::int32_t { load, drag };

/// A force on one body; several may act on the same one.
struct ForceElement {
  ForceType type = ForceType::load;
  BodyIndex body = 0;
  ReferenceFrame frame = ReferenceFrame::world;  // of `force` and `torque`
  Vec3 point_B;                                  // where the force acts, from the centre of mass [m]

  // load: grows linearly from zero at `start` to its full value at `start` + `ramp`; both zero: always full
  Vec3 force;                  // [N]
  Vec3 torque;                 // [N m]
  double start = 0, ramp = 0;  // in the world's time [s]

  // drag: 1/2 drag v^2 against the motion of the point through the air
  Real drag = 0;  // density times drag coefficient times area [kg/m]
  Vec3 wind;      // velocity of the air, world frame [m/s]
};

/// Drawbar load: `pull` [N] against `direction` (any length). With `frame` body the load turns with the body.
ForceElement tow_load(BodyIndex body, ReferenceFrame frame, const Vec3& direction, double pull,
                      const Vec3& point_B = {});

/// Density of the air [kg/m^3], drag coefficient [-], frontal area [m^2].
ForceElement aerodynamic_drag(BodyIndex body, double density, double coefficient, double area,
                              const Vec3& point_B = {});

/// Force and torque about a body's centre of mass, world frame.
struct ForceAndTorque {
  Vec3 force;   // [N]
  Vec3 torque;  // [N m]
};

/// Motion and mass of the body that a force acts on.
struct LoadedMotion {
  Quat orientation;
  Velocity velocity;
  Vec3 inverse_mass;          // along world x, y, z [1/kg]
  SymMat3 inverse_inertia_W;  // [1/(kg m^2)]
};

/// Share of a ramped load [0, 1].
GONOGO_HD inline double ramp_share(double time, double start, double ramp) {
  GONOGO_ASSERT(ramp >= 0);
  if (time >= start + ramp) return 1;
  return time > start ? (time - start) / ramp : 0;
}

/// Velocity that a unit impulse at `arm` along the unit vector `d` gives that point along d [1/kg].
GONOGO_HD inline Real inverse_mass_along(const LoadedMotion& m, const Vec3& arm, const Vec3& d) {
  const Vec3 turning = cross(arm, d);
  return dot(d, scale(m.inverse_mass, d)) + dot(turning, m.inverse_inertia_W * turning);
}

/// Mean force over a step of F = -1/2 c v^2. It is exact for a point mass m that moves straight, because
/// v' = -c v^2 / (2 m) has the solution v / (1 + c v t / (2 m)). It never reverses the motion, for any step.
GONOGO_HD inline Vec3 drag_force(const ForceElement& f, const LoadedMotion& m, const Vec3& arm, Real step) {
  const Vec3 through_air = m.velocity.linear + cross(m.velocity.angular, arm) - f.wind;
  GONOGO_ASSERT(f.drag >= 0 && step > 0);
  const Real speed = length(through_air);
  if (!(speed > 0)) return {};
  const Real rate = Real(0.5) * f.drag * speed;
  return -through_air * (rate / (1 + step * rate * inverse_mass_along(m, arm, through_air * (1 / speed))));
}

GONOGO_HD inline ForceAndTorque load_of(const ForceElement& f, const LoadedMotion& m, double time, Real step) {
  GONOGO_ASSERT(is_unit(m.orientation));
  const Vec3 arm = rotate(m.orientation, f.point_B);
  if (f.type == ForceType::drag) {
    const Vec3 force = drag_force(f, m, arm, step);
    return {force, cross(arm, force)};
  }
  const auto share = Real(ramp_share(time, f.start, f.ramp));
  Vec3 force = f.force * share, torque = f.torque * share;
  if (f.frame == ReferenceFrame::body) {
    force = rotate(m.orientation, force);
    torque = rotate(m.orientation, torque);
  }
  return {force, torque + cross(arm, force)};
}

/// A body and its range of forces, in the order in which the world lists them. An empty range: an empty place in a
/// batch.
struct LoadedBody {
  BodyIndex body = 0;
  Index first = 0, end = 0;  // forces
};

}  // namespace gonogo::sim
