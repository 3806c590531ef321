#include "sim/simulation/layout/part.h"

#include <algorithm>

#include "base/error.h"
#include "sim/constraint/bins.h"
#include "sim/state/contact_lists.h"

namespace gonogo::sim {
namespace {

/// Bins around a shape in which a halo body may lie. Bins are at least as wide as contacts reach, so bodies further
/// away have the width of a bin to go.
constexpr Index kHaloBins = 2;

ShapeIndex end_of_shapes(const FlatWorld& world, BodyIndex b) {
  return std::size_t(b) + 1 < world.first_shape.size() ? world.first_shape[b + 1] : ShapeIndex(world.shape.size());
}

void mark_elements(const FlatElements& element, std::vector<std::uint8_t>& shared) {
  for (const LoadedBody& l : element.loaded) shared[l.body] = 1;
  for (const ControllerPlan& c : element.controller) shared[c.body] = 1;
  for (const DrivelinePlan& d : element.driveline) shared[d.body] = 1;
  for (const MonitorPlan& m : element.monitor) shared[m.body] = 1;
}

std::vector<std::uint8_t> shared_bodies(const FlatWorld& world) {
  std::vector<std::uint8_t> shared(world.body.size());
  const FlatMechanisms& m = world.mechanisms;
  for (const MechanismBody& b : m.body) shared[b.body] = 1;
  for (const Joint& j : m.joint) shared[j.a.body] = shared[j.b.body] = 1;
  for (const SpringDamper& s : m.spring) shared[s.a.body] = shared[s.b.body] = 1;
  for (const Motor& motor : m.motor) {
    shared[motor.a] = 1;
    if (motor.b != kWorld) shared[motor.b] = 1;
  }
  for (const LargeShape& l : world.large) shared[world.shape[l.shape].body] = 1;
  mark_elements(world.element, shared);
  return shared;
}

/// One bit for each part.
using Mask = std::uint64_t;

/// Calls visit(bin) for the bins of a body's binned shapes.
template <class Visit>
void for_each_bin(const FlatWorld& world, const Snapshot& at, BodyIndex b, const Visit& visit) {
  for (ShapeIndex i = world.first_shape[b]; i < end_of_shapes(world, b); ++i) {
    if (world.bin_of_shape[i] < 0) continue;
    const Vec3d centre = at.position[b] + static_cast<Vec3d>(rotate(at.orientation[b], world.shape[i].offset_B));
    visit(bin_index(world.world, bin_of(world.world, centre)));
  }
}

/// Spreads marks along one axis. `stride`: between neighbours along it.
void spread(std::vector<Mask>& mark, Index count, Index stride) {
  const std::vector<Mask> from = mark;
  const Index reach = std::min(kHaloBins, count / 2);
  for (std::size_t bin = 0; bin < mark.size(); ++bin) {
    const Index at = Index(bin) / stride % count;
    for (Index d = -reach; d <= reach; ++d)
      mark[bin] |= from[bin + std::size_t((wrapped(at + d, count) - at) * stride)];
  }
}

/// Parts whose halo a body belongs to; its own among them. [body]
std::vector<Mask> parts_near(const FlatWorld& world, const Snapshot& at, const std::vector<BodyIndex>& border) {
  const Index* bins = world.world.bins;
  std::vector<Mask> mark(std::size_t(bins[0]) * bins[1] * bins[2]), near(world.body.size());
  for (std::size_t p = 0; p + 1 < border.size(); ++p)
    for (BodyIndex b = border[p]; b < border[p + 1]; ++b)
      for_each_bin(world, at, b, [&](Index bin) { mark[bin] |= Mask(1) << p; });
  spread(mark, bins[0], 1);
  spread(mark, bins[1], bins[0]);
  spread(mark, bins[2], bins[0] * bins[1]);
  for (BodyIndex b = 0; b < BodyIndex(near.size()); ++b)
    for_each_bin(world, at, b, [&](Index bin) { near[b] |= mark[bin]; });
  return near;
}

bool has_binned_shape(const FlatWorld& world, BodyIndex b) {
  const auto begin = world.bin_of_shape.begin();
  return std::any_of(begin + world.first_shape[b], begin + end_of_shapes(world, b), [](Index bin) { return bin >= 0; });
}

void add_body(const FlatWorld& world, BodyIndex b, bool own, bool shared, Part& part) {
  const auto at = BodyIndex(part.body.size());
  part.body.push_back(b);
  part.is_shared.push_back(shared);
  // The home of a shared body finds the contacts of its binned shapes, which may own them.
  const bool home = own && (!shared || has_binned_shape(world, b));
  part.strangeness.push_back(home ? own_body : shared ? shared_body : halo_body);
  if (shared && !is_fixed(world.mass[b])) part.moving_shared.push_back(at);
}

/// [index in the world] -> index in the part, -1: not there.
std::vector<Index> places(const std::vector<Index>& in_world, std::size_t world_count) {
  std::vector<Index> place(world_count, -1);
  for (std::size_t k = 0; k < in_world.size(); ++k) place[in_world[k]] = Index(k);
  return place;
}

void move_mechanisms(FlatMechanisms& m, const std::vector<BodyIndex>& place, const Part& part) {
  for (MechanismBody& b : m.body) b.body = place[b.body];
  for (Joint& j : m.joint) {
    j.a.body = place[j.a.body];
    j.b.body = place[j.b.body];
  }
  for (SpringDamper& s : m.spring) {
    s.a.body = place[s.a.body];
    s.b.body = place[s.b.body];
  }
  for (Motor& motor : m.motor) {
    motor.a = place[motor.a];
    if (motor.b != kWorld) motor.b = place[motor.b];
  }
  std::vector<Index> slot;
  for (const BodyIndex b : part.body) slot.push_back(m.slot_of_body[b]);
  m.slot_of_body = std::move(slot);
}

void move_elements(FlatElements& e, const std::vector<BodyIndex>& place) {
  for (ForceElement& f : e.force) f.body = place[f.body];
  for (LoadedBody& l : e.loaded) l.body = place[l.body];
  for (ControllerPlan& c : e.controller) c.body = place[c.body];
  for (DrivelinePlan& d : e.driveline) d.body = place[d.body];
  for (MonitorPlan& m : e.monitor) m.body = place[m.body];
}

}  // namespace

bool can_be_divided(const StepSettings& settings) {
  return !is_penalty(settings.contact) &&
         (settings.iteration == Iteration::apgd || settings.iteration == Iteration::jacobi);
}

Snapshot start_of(const FlatWorld& world) {
  Snapshot p;
  p.world = world.world;
  p.place_of_body = world.place_of_body;
  for (const BodyState& b : world.body) {
    p.position.push_back(b.position);
    p.orientation.push_back(b.orientation);
    p.velocity.push_back({b.velocity, 0, b.angular_velocity, 0});
  }
  p.contact_begin.resize(world.shape.size());
  p.contact_end.resize(world.shape.size());
  p.motor = world.mechanisms.motor;
  p.motor_impulse.resize(p.motor.size());
  p.element = {{},
               std::vector<ControllerState>(world.element.controller.size()),
               world.element.monitor_state,
               std::vector<MonitorSample>(std::size_t(world.element.sample_capacity)),
               world.element.driveline_state};
  return p;
}

std::vector<BodyIndex> borders(const FlatWorld& world, const Snapshot& at, int parts) {
  const auto bodies = BodyIndex(world.body.size());
  const auto load_until = [&](BodyIndex b) {
    const ShapeIndex shapes = b < bodies ? world.first_shape[b] : ShapeIndex(world.shape.size());
    return double(b) + (shapes > 0 ? double(at.contact_end[shapes - 1]) : 0.0);
  };
  std::vector<BodyIndex> border{0};
  const double all = load_until(bodies);
  BodyIndex b = 0;
  for (int p = 1; p < parts; ++p) {
    while (b < bodies && load_until(b) < all * p / parts) b = std::min(b + kTileSize, bodies);
    border.push_back(b);
  }
  border.push_back(bodies);
  return border;
}

Part part_of(const FlatWorld& world, const Snapshot& at, const std::vector<BodyIndex>& border, int number) {
  const std::size_t parts = border.size() - 1, own = std::size_t(number);
  GONOGO_ASSERT(parts <= std::size_t(kMaxParts));
  const std::vector<std::uint8_t> shared = shared_bodies(world);
  const std::vector<Mask> near = parts_near(world, at, border);
  Part part;
  part.sent.resize(parts);
  part.received.resize(parts);
  for (std::size_t p = 0; p < parts; ++p) {
    if (p == own) part.own_begin = BodyIndex(part.body.size());
    for (BodyIndex b = border[p]; b < border[p + 1]; ++b) {
      const bool here = near[b] >> own & 1, halo = p != own && here && !shared[b];
      if (p != own && !shared[b] && !halo) continue;
      if (halo) part.received[p].push_back(BodyIndex(part.body.size()));
      for (std::size_t q = 0; q < parts && p == own && !shared[b]; ++q)
        if (q != own && near[b] >> q & 1) part.sent[q].push_back(BodyIndex(part.body.size()));
      add_body(world, b, p == own, shared[b], part);
    }
    if (p == own) part.own_end = BodyIndex(part.body.size());
  }
  return part;
}

std::vector<ShapeIndex> shapes_in_world(const FlatWorld& world, const Part& part) {
  std::vector<ShapeIndex> shape;
  for (const BodyIndex b : part.body)
    for (ShapeIndex i = world.first_shape[b]; i < end_of_shapes(world, b); ++i) shape.push_back(i);
  return shape;
}

FlatWorld restricted(const FlatWorld& world, const Part& part) {
  const std::vector<BodyIndex> place = places(part.body, world.body.size());
  const std::vector<ShapeIndex> shape = shapes_in_world(world, part),
                                place_of_shape = places(shape, world.shape.size());
  FlatWorld to;
  to.scene = world.scene;
  to.world = world.world;
  to.mesh = world.mesh;
  to.heightfield = world.heightfield;
  for (const BodyIndex b : part.body) {
    to.place_of_body.push_back(BodyIndex(to.body.size()));
    to.body.push_back(world.body[b]);
    to.mass.push_back(world.mass[b]);
    to.first_shape.push_back(ShapeIndex(to.shape.size()));
    for (ShapeIndex i = world.first_shape[b]; i < end_of_shapes(world, b); ++i) {
      to.shape.push_back(world.shape[i]);
      to.shape.back().body = place[b];
      to.bin_of_shape.push_back(world.bin_of_shape[i]);
    }
  }
  to.large = world.large;
  for (LargeShape& l : to.large) l.shape = place_of_shape[l.shape];
  to.mechanisms = world.mechanisms;
  move_mechanisms(to.mechanisms, place, part);
  to.element = world.element;
  move_elements(to.element, place);
  to.world.body_count = Index(to.body.size());
  to.world.shape_count = Index(to.shape.size());
  return to;
}

Snapshot restricted(const Snapshot& snapshot, const FlatWorld& world, const Part& part, const FlatWorld& to) {
  const std::vector<ShapeIndex> shape = shapes_in_world(world, part), place = places(shape, world.shape.size());
  Snapshot p;
  p.world = to.world;
  p.steps = snapshot.steps;
  p.flags = snapshot.flags;
  p.slowed = snapshot.slowed;
  p.place_of_body = to.place_of_body;
  for (const BodyIndex b : part.body) {
    p.position.push_back(snapshot.position[b]);
    p.orientation.push_back(snapshot.orientation[b]);
    p.velocity.push_back(snapshot.velocity[b]);
  }
  for (const ShapeIndex i : shape) {
    p.contact_begin.push_back(Index(p.key.size()));
    for (Index k = snapshot.contact_begin[i]; k < snapshot.contact_end[i]; ++k) {
      const ShapeIndex other = other_shape(snapshot.key[k]);
      if (place[other] < 0) continue;
      p.key.push_back(shifted_key(snapshot.key[k], place[other] - other));
      p.impulse.push_back(snapshot.impulse[k]);
    }
    p.contact_end.push_back(Index(p.key.size()));
  }
  p.motor = to.mechanisms.motor;
  p.motor_impulse = snapshot.motor_impulse;
  p.element = snapshot.element;
  return p;
}

double halo_margin(const WorldParameters& world) {
  return 0.5 * double(std::min({world.bin_size.x, world.bin_size.y, world.bin_size.z}));
}

}  // namespace gonogo::sim
