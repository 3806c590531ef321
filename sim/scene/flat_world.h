// Worlds as the engine takes them: checked, as flat arrays, bodies in spatial order.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "sim/scene/flatten.h"
#include "sim/state/fault.h"

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

}  // namespace gonogo::sim
