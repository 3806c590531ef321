// Description of a batch of worlds, from which a simulation is made. Host only.
#pragma once
#include <memory>
#include <vector>

#include "base/units.h"
#include "sim/shape/triangle_mesh.h"
#include "sim/state/elements.h"
#include "sim/state/mechanism.h"
#include "sim/state/world.h"

namespace gonogo::sim {

struct SphereCover;

/// Position and motion of one body; world frame.
struct BodyState {
  Vec3d position;  // centre of mass [m]
  Quat orientation;
  Vec3 velocity;          // [m/s]
  Vec3 angular_velocity;  // [rad/s]
};

/// One world: a box [origin, origin + size], periodic along x and y where asked. Bodies are numbered from 0 in each
/// world; shapes must be listed in ascending order of their body.
struct SceneWorld {
  Vec3 gravity{0, 0, Real(-kGravity)};  // [m/s^2]
  Vec3d origin, size{1, 1, 1};          // [m]
  bool periodic_x = false, periodic_y = false;
  PairLaw law[kMaxMaterials][kMaxMaterials];
  PenaltyLaw penalty[kMaxMaterials][kMaxMaterials];  // for the penalty family; without stiffness: the settings'
  /// Max overlap of two shapes at the start, as a share of the smaller one's smallest half extent; 0: not checked.
  Real overlap_limit = 0;

  std::vector<BodyState> body;
  std::vector<BodyMass> mass;
  std::vector<Shape> shape;
  std::vector<Joint> joint;  // sim/scene/scene.h makes these three
  std::vector<SpringDamper> spring;
  std::vector<std::shared_ptr<const TriangleMesh>> mesh;        // by add_mesh; shapes refer to them by index
  std::vector<std::shared_ptr<const Heightfield>> heightfield;  // by add_heightfield
  std::vector<Motor> motor;
  std::vector<ForceElement> force;
  std::vector<Controller> controller;
  std::vector<Driveline> driveline;
  std::vector<Monitor> monitor;

  /// Adds a body without shapes; returns its index in this world.
  BodyIndex add_body(const BodyState& state, const BodyMass& body_mass);
  /// Adds a solid sphere of one material; returns the index of its body.
  BodyIndex add_sphere(const Vec3d& position, Real radius, Real density, int material);
  /// Adds a solid ellipsoid of one material, half axes along those of the body; returns the index of its body.
  BodyIndex add_ellipsoid(const BodyState& state, const Vec3& half, Real density, int material);
  void add_shape(const Shape& s);
  /// Returns the index for Shape::surface. Throws InputError for what check_mesh and check_heightfield refuse. To share
  /// a mesh between worlds, push the pointer to the other world's list.
  std::int32_t add_mesh(TriangleMesh m);
  std::int32_t add_heightfield(Heightfield f);
  /// Same law for both orders of the pair.
  void set_law(int material_a, int material_b, const PairLaw& l);
  void set_penalty(int material_a, int material_b, const PenaltyLaw& l);
};

/// Mass properties from a mass [kg] and principal moments of inertia [kg m^2]; zero mass means fixed.
BodyMass solid(Real mass, const Vec3& inertia_B);
BodyMass fixed_body();

using Scene = std::vector<SceneWorld>;

/// A body that does not move, for places of a batch that nobody has: stepping it costs next to nothing.
SceneWorld vacant_world();

/// Adds a body with the mass properties of the mesh as a solid of this density [kg/m^3], and the spheres of the cover
/// as its shapes. `at`: position and orientation of the mesh's axes, and velocity of its centre of mass. The body's
/// axes are its principal axes of inertia. Returns the body's index.
BodyIndex add_compound(SceneWorld& world, const BodyState& at, const TriangleMesh& mesh, const SphereCover& cover,
                       double density, int material);

// Joints, springs and motors from points and axes in the world, for the bodies where they are now. They throw
// InputError for a body that is not in the world and for an axis without direction.

/// `side_W` need not be at right angles to the axis; without one, any is taken.
Attachment attach(const SceneWorld& world, BodyIndex body, const Vec3d& point_W, const Vec3d& axis_W,
                  const Vec3d& side_W = {});

Joint revolute(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_W);
Joint spherical(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W);
Joint prismatic(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_W);
Joint fixed(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W);
/// a's point stays on the line through b's along the axis.
Joint in_line(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_W);
/// Turn equally fast from now on, each about the axis that turns with it.
Joint equal_spin(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& axis_a_W, const Vec3d& axis_b_W);
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
