// Description of a batch of worlds, from which a simulation is made.
#pragma once
#include <memory>
#include <vector>

#include "base/units.h"
#include "sim/shape/triangle_mesh.h"
#include "sim/state/elements.h"
#include "sim/state/joint.h"
#include "sim/state/world.h"

namespace gonogo::sim {

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
  std::vector<Joint> joint;  // sim/scene/build_joint.h makes these three
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

}  // namespace gonogo::sim
