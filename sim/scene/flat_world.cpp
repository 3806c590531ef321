#include "sim/scene/flat_world.h"

#include <algorithm>

#include "base/error.h"
#include "sim/contact/bins.h"
#include "sim/contact/finder.h"
#include "sim/scene/check_contact.h"
#include "sim/scene/check_joint.h"
#include "sim/scene/check_shape.h"
#include "sim/scene/check_world.h"
#include "sim/scene/critical_step.h"
#include "sim/scene/layout.h"
#include "sim/scene/order.h"
#include "sim/scene/prepare_elements.h"

namespace gonogo::sim {
namespace {

std::string in_world(std::size_t w) { return "world " + std::to_string(w) + ": "; }

void check_world(const SceneWorld& world, std::size_t w) {
  if (world.body.empty()) throw InputError(in_world(w) + "has no bodies");
  if (!(world.size.x > 0 && world.size.y > 0 && world.size.z > 0))
    throw InputError(in_world(w) + "its size must be above zero");
  check_bodies(world, w);
  check_shapes(world, w);
}

WorldParameters world_parameters(const SceneWorld& world, const StepSettings& settings, std::size_t w) {
  WorldParameters p;
  p.gravity = world.gravity;
  p.origin = world.origin;
  p.period = {world.periodic_x ? world.size.x : 0, world.periodic_y ? world.size.y : 0, 0};
  std::copy(&world.law[0][0], &world.law[0][0] + kMaxMaterials * kMaxMaterials, &p.law[0][0]);
  lay_out_bins(world, settings, w, p);
  return p;
}

/// The same world with its bodies in another order.
SceneWorld reordered(const SceneWorld& world, const std::vector<BodyIndex>& place) {
  SceneWorld r = world;
  for (std::size_t b = 0; b < place.size(); ++b) {
    r.body[place[b]] = world.body[b];
    r.mass[place[b]] = world.mass[b];
  }
  for (Shape& s : r.shape) s.body = place[s.body];
  std::stable_sort(r.shape.begin(), r.shape.end(), [](const Shape& a, const Shape& b) { return a.body < b.body; });
  for_each_jointed(r, [&](BodyIndex& b) { b = place[b]; });
  for (ForceElement& f : r.force) f.body = place[f.body];
  for (Controller& c : r.controller)
    if (follows_body(c)) c.body = place[c.body];
  for (Driveline& d : r.driveline) d.body = place[d.body];
  for (Monitor& m : r.monitor) m.body = place[m.body];
  return r;
}

/// Large shapes along a curve through the places of their bodies at the start, so that groups of them are compact.
void sort_by_place(const SceneWorld& world, const std::vector<Shape>& shape, std::vector<LargeShape>& large) {
  std::vector<Vec3d> position;
  for (const LargeShape& l : large) position.push_back(world.body[shape[l.shape].body].position);
  const std::vector<Index> place = order_along_curve(position);
  std::vector<LargeShape> sorted(large.size());
  for (std::size_t k = 0; k < large.size(); ++k) sorted[place[k]] = large[k];
  large = sorted;
}

void append_shapes(const SceneWorld& world, Real binned_up_to, FlatWorld& flat) {
  std::size_t next = 0;
  for (BodyIndex b = 0; b < BodyIndex(world.body.size()); ++b) {
    flat.first_shape.push_back(Index(flat.shape.size()));
    for (; next < world.shape.size() && world.shape[next].body == b; ++next) {
      const Shape& s = world.shape[next];
      const bool binned = is_binned(s, binned_up_to);
      if (!binned) flat.large.push_back({ShapeIndex(flat.shape.size()), {}, {}, {}});
      flat.bin_of_shape.push_back(binned ? 0 : -1);
      flat.shape.push_back(s);
    }
  }
  if (flat.large.size() >= std::size_t(kGroupedFrom)) sort_by_place(world, flat.shape, flat.large);
  flat.world.large_count = Index(flat.large.size());
  flat.world.shape_count = Index(flat.shape.size());
}

void append_masses(const SceneWorld& world, FlatWorld& flat) {
  for (std::size_t b = 0; b < world.mass.size(); ++b) {
    BodyMass m = world.mass[b];
    m.isotropic = m.inverse_inertia_B.x == m.inverse_inertia_B.y && m.inverse_inertia_B.y == m.inverse_inertia_B.z;
    m.slot = flat.mechanisms.slot_of_body[b];
    flat.mass.push_back(m);
  }
}

std::vector<Vec3d> positions(const SceneWorld& world) {
  std::vector<Vec3d> position;
  for (const BodyState& body : world.body) position.push_back(body.position);
  return position;
}

/// A checked world with its bodies in a given order.
FlatWorld arranged(std::shared_ptr<const SceneWorld> scene, const WorldParameters& parameters,
                   std::vector<BodyIndex> place_of_body, const StepSettings& settings, const std::string& where) {
  const SceneWorld world = reordered(*scene, place_of_body);
  FlatWorld flat;
  flat.scene = std::move(scene);
  flat.world = parameters;
  flat.world.body_count = Index(world.body.size());
  flat.place_of_body = std::move(place_of_body);
  flat.body = world.body;
  flat.mesh = world.mesh;
  flat.heightfield = world.heightfield;
  flat.mechanisms = flatten_mechanisms(world, where);
  flat.element = flat_elements(world, settings);
  append_shapes(world, binned_radius(world, settings), flat);
  append_masses(world, flat);
  return flat;
}

/// Place in one order -> place in another, from what both say of the scene's bodies.
std::vector<BodyIndex> way(const std::vector<BodyIndex>& from, const std::vector<BodyIndex>& to) {
  std::vector<BodyIndex> moved(from.size());
  for (std::size_t b = 0; b < from.size(); ++b) moved[from[b]] = to[b];
  return moved;
}

template <class T>
std::vector<T> permuted(const std::vector<T>& list, const std::vector<Index>& place) {
  std::vector<T> result(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) result[place[i]] = list[i];
  return result;
}

/// A body takes its shapes with it.
std::vector<ShapeIndex> way_of_shapes(const FlatWorld& from, const FlatWorld& to, const std::vector<BodyIndex>& way) {
  std::vector<ShapeIndex> moved(from.shape.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const BodyIndex b = from.shape[i].body;
    moved[i] = to.first_shape[way[b]] + ShapeIndex(i) - from.first_shape[b];
  }
  return moved;
}

}  // namespace

WorldSize FlatWorld::size() const {
  return {Index(body.size()),  Index(shape.size()), world.bins[0] * world.bins[1] * world.bins[2],
          Index(large.size()), mechanisms.size(),   element.size()};
}

WorldSize larger(const WorldSize& a, const WorldSize& b) {
  return {std::max(a.bodies, b.bodies),       std::max(a.shapes, b.shapes),
          std::max(a.bins, b.bins),           std::max(a.large_shapes, b.large_shapes),
          larger(a.mechanisms, b.mechanisms), larger(a.elements, b.elements)};
}

FlatWorld flatten(const SceneWorld& given, WorldIndex w, const StepSettings& settings) {
  const std::string where = in_world(std::size_t(w));
  check_world(given, std::size_t(w));
  check_mechanisms(given, where);
  check_elements(given, std::size_t(w), settings);
  const auto scene = std::make_shared<SceneWorld>(given);
  set_surface_sizes(*scene);
  if (is_penalty(settings.solver)) check_penalty(*scene, std::size_t(w), settings);
  const WorldParameters parameters = world_parameters(*scene, settings, std::size_t(w));
  FlatWorld flat = arranged(scene, parameters, spatial_order(positions(*scene), parameters), settings, where);
  check_pairs(flat, w);
  if (given.overlap_limit > 0) check_overlaps(flat, w, settings, given.overlap_limit);
  return flat;
}

FlatWorld rearranged(const FlatWorld& world, std::vector<BodyIndex> place_of_body, const StepSettings& settings) {
  FlatWorld flat = arranged(world.scene, world.world, std::move(place_of_body), settings, {});
  for (std::size_t m = 0; m < flat.mechanisms.motor.size(); ++m) {
    flat.mechanisms.motor[m].target = world.mechanisms.motor[m].target;
    flat.mechanisms.motor[m].max_torque = world.mechanisms.motor[m].max_torque;
  }
  return flat;
}

Snapshot rearranged(const Snapshot& snapshot, const FlatWorld& from, const FlatWorld& to) {
  const std::vector<BodyIndex> bodies = way(from.place_of_body, to.place_of_body);
  const std::vector<ShapeIndex> shapes = way_of_shapes(from, to, bodies);
  Snapshot p = snapshot;
  p.place_of_body = to.place_of_body;
  if (p.fault.flags != 0) p.fault.body = bodies[p.fault.body];
  p.position = permuted(snapshot.position, bodies);
  p.orientation = permuted(snapshot.orientation, bodies);
  p.velocity = permuted(snapshot.velocity, bodies);
  p.motor = to.mechanisms.motor;
  p.key.clear();
  p.impulse.clear();
  p.history.clear();
  const std::vector<Index> begin = permuted(snapshot.contact_begin, shapes),
                           end = permuted(snapshot.contact_end, shapes);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    p.contact_begin[i] = Index(p.key.size());
    for (Index k = begin[i]; k < end[i]; ++k) {
      const std::uint64_t key = snapshot.key[k];
      p.key.push_back(shifted_key(key, shapes[other_shape(key)] - other_shape(key)));
      p.impulse.push_back(snapshot.impulse[k]);
      if (!snapshot.history.empty()) p.history.push_back(snapshot.history[k]);
    }
    p.contact_end[i] = Index(p.key.size());
  }
  return p;
}

}  // namespace gonogo::sim
