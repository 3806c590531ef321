// The arrays of a batch: lays out the places of its worlds, and writes a world when it enters or its laws change.
#pragma once
#include <utility>

#include "sim/constraint/find_contacts.h"
#include "sim/scene/flat_mechanisms.h"
#include "sim/scene/flat_world.h"
#include "sim/scene/penalty_setup.h"

namespace gonogo::sim {

/// Where a world's parts begin in the arrays of the batch, and how much its place holds.
struct Place {
  BodyIndex body = 0;
  ShapeIndex shape = 0;
  Index bin = 0, large = 0;
  MechanismSize mechanisms;
  ElementSize elements;
  WorldSize size;
};

/// Whether a world needs the kernels that turn; only they know softness.
inline bool needs_turning(const WorldParameters& world, const StepSettings& settings) {
  bool turning = settings.give > 0;
  for (const auto& row : world.law)
    for (const PairLaw& law : row)
      turning = turning || law.rolling_friction > 0 || law.spinning_friction > 0 || law.stiffness > 0;
  return turning;
}

/// Sizes of the places of a batch.
inline std::vector<WorldSize> places_for(const std::vector<FlatWorld>& worlds, const WorldSize& room) {
  std::vector<WorldSize> size;
  for (const FlatWorld& world : worlds) size.push_back(larger(world.size(), room));
  return size;
}

template <class Exec>
struct BatchArrays {
  State<Exec> state;
  std::vector<FlatWorld> flat;  // as they entered, with the present laws, gravity and motors
  std::vector<Place> place;     // [world]
  bool changed = false;         // buffers have moved or other kernels are needed: recorded steps are invalid

  BatchArrays(std::vector<FlatWorld> worlds, const WorldSize& room, const StepSettings& settings)
      : flat(std::move(worlds)), settings_(settings) {
    lay_out(places_for(flat, room));
    allocate();
    for (WorldIndex w = 0; w < state.world_count; ++w) write_world(w);
  }

  /// Places of these sizes without worlds.
  BatchArrays(const std::vector<WorldSize>& sizes, const StepSettings& settings) : settings_(settings) {
    lay_out(sizes);
    allocate();
  }

  /// Throws InputError, naming the numbers, when the place is too small.
  void replace(WorldIndex w, FlatWorld world) {
    check_fits(w, world.size());
    flat[w] = std::move(world);
    write_world(w);
  }

  BodyIndex in_batch(WorldIndex w, BodyIndex b) const {
    GONOGO_ASSERT(std::size_t(w) < flat.size() && std::size_t(b) < flat[w].place_of_body.size());
    return place[w].body + flat[w].place_of_body[b];
  }

  ElementPlace element_place(WorldIndex w) const {
    const Place& at = place[w];
    const FlatMechanisms& m = flat[w].mechanisms;
    return {.world = w,
            .body = at.body,
            .motor = at.mechanisms.motors,
            .motor_count = Index(m.motor.size()),
            .spring = at.mechanisms.springs,
            .spring_count = Index(m.spring.size()),
            .first = at.elements,
            .room = at.size.elements};
  }

  void write_parameters(WorldIndex w) {
    WorldParameters p = flat[w].world;
    const Place& at = place[w];
    p.first_body = at.body;
    p.first_shape = at.shape;
    p.first_bin = at.bin;
    p.first_large = at.large;
    p.first_motor = at.mechanisms.motors;
    p.motor_count = Index(flat[w].mechanisms.motor.size());
    state.world.write(w, p);
    if (state.remembers) state.penalty.write(w * kPenaltyPairs, penalty_numbers(*flat[w].scene, settings_));
    const bool turning = state.turning || needs_turning(p, settings_);
    changed = changed || turning != state.turning;
    state.turning = turning;
  }

  /// Gives all points of a world's table this value.
  void hold(WorldIndex w, const Table& table, double value) {
    GONOGO_ASSERT(std::size_t(table.first + table.count) <= flat[w].element.table.size());
    const auto first = flat[w].element.table.begin() + table.first;
    for (auto point = first; point != first + table.count; ++point) point->value = value;
    state.element.table.write(place[w].elements.table_points + table.first,
                              std::vector<TablePoint>(first, first + table.count));
  }

  void write_motors(WorldIndex w) { state.mechanisms.motor.write(place[w].mechanisms.motors, in_batch(w).motor); }

 private:
  FlatMechanisms in_batch(WorldIndex w) const {
    return moved(flat[w].mechanisms, place[w].mechanisms, w, place[w].body);
  }

  void lay_out(const std::vector<WorldSize>& sizes) {
    Place next;
    for (const WorldSize& size : sizes) {
      next.size = size;
      place.push_back(next);
      next.body += next.size.bodies;
      next.shape += next.size.shapes;
      next.bin += next.size.bins;
      next.large += next.size.large_shapes;
      next.mechanisms = next.mechanisms + next.size.mechanisms;
      next.elements = after(next.elements, next.size.elements);
    }
    state.world_count = Index(sizes.size());
    state.body_count = next.body;
    state.shape_count = next.shape;
    state.bin_count = next.bin;
    large_total_ = next.large;
    mechanism_total_ = next.mechanisms;
    element_total_ = next.elements;
  }

  void check_fits(WorldIndex w, const WorldSize& size) const {
    const WorldSize& room = place[w].size;
    check_part(w, "bodies", size.bodies, room.bodies);
    check_part(w, "shapes", size.shapes, room.shapes);
    check_part(w, "bins", size.bins, room.bins);
    check_part(w, "large shapes", size.large_shapes, room.large_shapes);
    for (const ElementPart& part : kElementParts)
      check_part(w, part.name, size.elements.*part.count, room.elements.*part.count);
    for (const MechanismPart& part : kMechanismParts)
      check_part(w, part.name, size.mechanisms.*part.count, room.mechanisms.*part.count);
  }

  static void check_part(WorldIndex w, const char* name, Index count, Index room) {
    if (count > room)
      throw InputError("the new world has " + std::to_string(count) + " " + name + ", place " + std::to_string(w) +
                       " holds " + std::to_string(room) + "; make the simulation with more room");
  }

  void write_world(WorldIndex w) {
    GONOGO_ASSERT(larger(flat[w].size(), place[w].size) == place[w].size);
    write_parameters(w);
    write_bodies(w);
    write_shapes(w);
    const Place& at = place[w];
    write_mechanisms(state.mechanisms, in_batch(w), at.mechanisms, at.size.mechanisms);
    state.element.write(flat[w].element, element_place(w));
    state.steps.write(w, 0);
    state.flags.write(w, 0);
    state.slowed.write(w, 0);
    state.fault.write(w, kNoFault);
    state.world_sums.write(w, WorldSums{});
  }

  /// Fills the rest of the place with fixed bodies without shapes.
  void write_bodies(WorldIndex w) {
    const Place& at = place[w];
    std::vector<Vec3d> position(at.size.bodies, flat[w].world.origin);
    std::vector<Quat> orientation(at.size.bodies);
    std::vector<Velocity> velocity(at.size.bodies);
    for (std::size_t b = 0; b < flat[w].body.size(); ++b) {
      const BodyState& state = flat[w].body[b];
      position[b] = state.position;
      orientation[b] = state.orientation;
      velocity[b] = {state.velocity, 0, state.angular_velocity, 0};
    }
    std::vector<BodyMass> mass = flat[w].mass;
    mass.resize(at.size.bodies, fixed_body());
    for (BodyMass& m : mass)
      if (m.slot >= 0) m.slot += at.mechanisms.bodies;
    state.position.write(at.body, position);
    state.orientation.write(at.body, orientation);
    state.velocity.write(at.body, velocity);
    state.mass.write(at.body, mass);
    state.world_of_body.write(at.body, std::vector<WorldIndex>(at.size.bodies, w));
  }

  void write_shapes(WorldIndex w) {
    const Place& at = place[w];
    std::vector<Shape> shape = flat[w].shape;
    GONOGO_ASSERT(flat[w].first_shape.size() == flat[w].body.size() && flat[w].bin_of_shape.size() == shape.size());
    for (Shape& s : shape) s.body += at.body;
    place_surfaces(w, shape);
    Shape none;
    none.type = ShapeType::none;
    none.body = at.body;
    shape.resize(at.size.shapes, none);
    std::vector<Index> first = flat[w].first_shape, bin = flat[w].bin_of_shape;
    for (Index& i : first) i += at.shape;
    first.resize(at.size.bodies, at.shape + at.size.shapes);
    bin.resize(at.size.shapes, -1);
    for (std::size_t i = 0; i < bin.size() && !state.solids_binned; ++i)
      if (bin[i] >= 0 && shape[i].type != ShapeType::sphere) state.solids_binned = changed = true;
    std::vector<LargeShape> large = flat[w].large;
    for (LargeShape& l : large) l.shape += at.shape;
    state.shape.write(at.shape, shape);
    state.first_shape.write(at.body, first);
    state.bin_of_shape.write(at.shape, bin);
    state.large.write(at.large, large);
    state.store[1 - state.parity].begin.write(at.shape, std::vector<Index>(at.size.shapes));
    state.store[1 - state.parity].end.write(at.shape, std::vector<Index>(at.size.shapes));
  }

  /// Adds the world's meshes and heightfields to those of the batch.
  void place_surfaces(WorldIndex w, std::vector<Shape>& shape) {
    const FlatWorld& own = flat[w];
    if (own.mesh.empty() && own.heightfield.empty()) return;
    for (Shape& s : shape) {
      if (s.type == ShapeType::mesh) s.surface = library_.add(own.mesh[s.surface]);
      if (s.type == ShapeType::heightfield) s.surface = library_.add(own.heightfield[s.surface]);
    }
    if (library_.size() == state.surfaces.size()) return;
    state.surfaces.upload(library_);
    changed = true;
  }

  void allocate() {
    state.remembers = is_penalty(settings_.contact);
    for (auto* of_body : {&state.velocity, &state.velocity_change, &state.free_velocity, &state.extrapolated_velocity,
                          &state.substep_velocity, &state.earlier_velocity})
      of_body->fill_zero(state.body_count);
    state.position.fill_zero(state.body_count);
    state.orientation.fill_zero(state.body_count);
    state.mass.fill_zero(state.body_count);
    state.world_of_body.fill_zero(state.body_count);
    state.inverse_inertia_W.fill_zero(state.body_count);
    for (auto* offsets : {&state.first_shape, &state.first_second}) offsets->fill_zero(state.body_count + 1);
    state.first_shape.write(state.body_count, state.shape_count);
    state.world.fill_zero(state.world_count);
    if (state.remembers) state.penalty.fill_zero(std::size_t(state.world_count) * kPenaltyPairs);
    state.world_sums.fill_zero(state.world_count);
    state.momentum.fill_zero(state.world_count);
    for (auto* of_world : {&state.flags, &state.slowed, &state.slowed_now, &state.steps, &state.tiles_of_world})
      of_world->fill_zero(state.world_count);
    state.first_tile.fill_zero(state.world_count + 1);
    state.fault.fill_zero(state.world_count);
    gonogo::sim::allocate(state.mechanisms, mechanism_total_);
    state.element.allocate(state.world_count, element_total_);
    allocate_shapes();
    lay_out_body_tiles();
    reserve_contacts(state, std::max<Index>(4 * state.shape_count, 1024));
  }

  void lay_out_body_tiles() {
    std::vector<Index> first{0};
    std::vector<WorldIndex> world;
    for (std::size_t w = 0; w < place.size(); ++w) {
      first.push_back(first.back() + (place[w].size.bodies + kTileSize - 1) / kTileSize);
      world.resize(first.back(), WorldIndex(w));
    }
    state.first_body_tile.upload(first);
    state.world_of_body_tile.upload(world);
  }

  void allocate_shapes() {
    state.shape.fill_zero(state.shape_count);
    state.bin_of_shape.fill_zero(state.shape_count);
    state.large.fill_zero(large_total_);
    Index max_large = 0;
    for (const Place& p : place) max_large = std::max(max_large, p.size.large_shapes);
    reserve_search(state, max_large);
  }

  StepSettings settings_;
  Index large_total_ = 0;
  MechanismSize mechanism_total_;
  ElementSize element_total_;
  SurfaceLibrary library_;
};

}  // namespace gonogo::sim
