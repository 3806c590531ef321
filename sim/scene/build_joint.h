// Joints, springs and motors from points and axes in the world, for the bodies where they are now. All throw InputError
// for a body that is not in the world and for an axis without direction.
#pragma once
#include "sim/scene/scene.h"

namespace gonogo::sim {

/// `side_W` need not be at right angles to the axis; without one, any is taken.
Attachment attach(const SceneWorld& world, BodyIndex body, const Vec3d& point_W, const Vec3d& axis_W,
                  const Vec3d& side_W = {});

Joint revolute(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_W);
Joint spherical(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W);
Joint prismatic(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_W);
Joint fixed(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W);
/// a's point stays on the line through b's along the axis.
Joint in_line(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_W);
/// Keeps the distance that the points have now.
Joint distance(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_a_W, const Vec3d& point_b_W);
/// `axis_a_W` turns with a, `axis_b_W` with b; they must be at right angles.
Joint universal(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_a_W,
                const Vec3d& axis_b_W);

/// Along the line between two points; unloaded at their present distance. [N/m, N s/m]
SpringDamper spring_between(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_a_W,
                            const Vec3d& point_b_W, double stiffness, double damping);
/// Along an axis that turns with b, whatever the offset across it; unloaded where a's point is now. [N/m, N s/m]
SpringDamper spring_along(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_a_W,
                          const Vec3d& point_b_W, const Vec3d& axis_W, double stiffness, double damping);
/// Along the axis of a prismatic joint; unloaded when a is `free_length` along it [m]. [N/m, N s/m]
SpringDamper spring_along(const Joint& prismatic, double free_length, double stiffness, double damping);
/// About the axis of a revolute joint; unloaded when a has turned by `free_angle` from where it was when the joint was
/// made [rad]. [N m/rad, N m s/rad]
SpringDamper spring_about(const Joint& revolute, double free_angle, double stiffness, double damping);

/// Holds a speed of a relative to b [rad/s] with limited torque [N m]; b may be kWorld.
Motor speed_motor(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& axis_W, double speed,
                  double max_torque);
Motor speed_motor(const Joint& revolute, double speed, double max_torque);
/// Torque on a about the axis [N m], its opposite on b.
Motor torque_motor(const Joint& revolute, double torque);

/// Points from (stretch, force) pairs; see ForceTable.
ForceTable force_table(const std::vector<std::pair<double, double>>& points);

}  // namespace gonogo::sim
