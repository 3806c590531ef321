// Host description of a batch of worlds, before it goes to a backend.
#pragma once
#include <memory>
#include <vector>

#include "sim/shape/triangle_mesh.h"
#include "sim/world/state.h"

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
  Vec3 gravity{0, 0, Real(-9.81)};  // [m/s^2]
  Vec3d origin, size{1, 1, 1};      // [m]
  bool periodic_x = false, periodic_y = false;
  PairLaw law[kMaxMaterials][kMaxMaterials];

  std::vector<BodyState> body;
  std::vector<BodyMass> mass;
  std::vector<Shape> shape;
  std::vector<Motor> motor;
  std::vector<SpringDamper> spring;
  std::vector<std::shared_ptr<const TriangleMesh>> mesh;        // shapes refer to them by index; worlds may share them
  std::vector<std::shared_ptr<const Heightfield>> heightfield;  // the same

  /// Adds a body without shapes; returns its index in this world.
  BodyIndex add_body(const BodyState& state, const BodyMass& body_mass);
  /// Adds a solid sphere of one material; returns the index of its body.
  BodyIndex add_sphere(const Vec3d& position, Real radius, Real density, int material);
  void add_shape(const Shape& s);
  /// Returns the index for Shape::surface.
  std::int32_t add_mesh(TriangleMesh m);
  std::int32_t add_heightfield(Heightfield f);
  /// Same law for both orders of the pair.
  void set_law(int material_a, int material_b, const PairLaw& l);
};

/// Mass properties from a mass [kg] and principal moments of inertia [kg m^2]; zero mass means fixed.
BodyMass solid(Real mass, const Vec3& inertia_B);
BodyMass fixed_body();

using Scene = std::vector<SceneWorld>;

}  // namespace gonogo::sim
