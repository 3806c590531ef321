// Worlds as the engine takes them: checked, as flat arrays. Bodies lie along a space-filling curve, so that neighbours
// in space, which the solver reads together, are neighbours in memory. Host only.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "sim/scene/flat_mechanisms.h"
#include "sim/scene/scene.h"
#include "sim/state/world.h"

namespace gonogo::sim {

/// Sizes of a world, or of its place in a batch.
struct WorldSize {
  Index bodies = 0, shapes = 0, bins = 0, large_shapes = 0;
  MechanismSize mechanisms;
  ElementSize elements;

  bool operator==(const WorldSize&) const = default;
};
/// The larger of each number.
WorldSize larger(const WorldSize& a, const WorldSize& b);

/// A checked world as flat arrays; all indices count from zero. Bodies are in spatial order, so that neighbours in
/// space are neighbours in memory.
struct FlatWorld {
  std::shared_ptr<const SceneWorld> scene;  // as given, checked
  WorldParameters world;
  std::vector<BodyIndex> place_of_body;  // index in the scene -> index here
  std::vector<BodyState> body;
  std::vector<BodyMass> mass;
  std::vector<Shape> shape;
  std::vector<Index> first_shape, bin_of_shape;  // [body], [shape]
  std::vector<LargeShape> large;
  std::vector<std::shared_ptr<const TriangleMesh>> mesh;
  std::vector<std::shared_ptr<const Heightfield>> heightfield;
  FlatMechanisms mechanisms;
  FlatElements element;

  WorldSize size() const;
};
FlatWorld flatten(const SceneWorld& given, WorldIndex w, const StepSettings& settings);

/// State from which a world continues with the same bits, in this batch or another.
struct Snapshot {
  WorldParameters world;
  Index steps = 0, flags = 0, slowed = 0;
  Fault fault;                           // its body in the engine's own order
  std::vector<BodyIndex> place_of_body;  // index in the scene -> index in the engine's own order
  std::vector<Vec3d> position;           // bodies, shapes and motors in the engine's own order
  std::vector<Quat> orientation;
  std::vector<Velocity> velocity;
  std::vector<Index> contact_begin, contact_end;  // [shape] into the arrays below
  std::vector<std::uint64_t> key;
  std::vector<Impulse> impulse;
  std::vector<ContactHistory> history;  // as many, or none where contacts remember nothing
  std::vector<Motor> motor;
  std::vector<Real> motor_impulse;
  ElementSnapshot element;
};

/// The same world with its bodies in another order in memory, and its present laws, gravity and motors.
FlatWorld rearranged(const FlatWorld& world, std::vector<BodyIndex> place_of_body, const StepSettings& settings);

/// A snapshot of `from` for the same world in another order.
Snapshot rearranged(const Snapshot& snapshot, const FlatWorld& from, const FlatWorld& to);

/// Max bounding radius of binned shapes [m]; 0 when the world has none. It is at most four times the smallest radius,
/// and the few shapes much larger than all others stay out, so that one box does not widen the bins of a whole bed.
Real binned_radius(const SceneWorld& world, const StepSettings& settings);

bool is_binned(const Shape& s, Real binned_radius);

/// Sets bin_size and bins of `p`: at most a few bins per binned shape, for any size of the domain. Throws InputError,
/// naming world `w`, when a periodic side is too short for the world's spheres.
void lay_out_bins(const SceneWorld& world, const StepSettings& settings, std::size_t w, WorldParameters& p);

/// Index in the list -> place along the curve of Morton (1966) through the world's bins. Bodies of one bin keep their
/// order.
std::vector<BodyIndex> spatial_order(const std::vector<Vec3d>& position, const WorldParameters& world);

/// The same with 1023 cells a side of the cube around all positions instead of bins.
std::vector<Index> order_along_curve(const std::vector<Vec3d>& position);

/// Whether sorting pays: compares, before and after, how many bodies have their successor in memory in the same or an
/// adjacent bin. `place`: from spatial_order().
bool have_mixed(const std::vector<Vec3d>& position, const std::vector<BodyIndex>& place, const WorldParameters& world);

/// Order `first`, then order `second`.
std::vector<BodyIndex> composed(const std::vector<BodyIndex>& first, const std::vector<BodyIndex>& second);

}  // namespace gonogo::sim
