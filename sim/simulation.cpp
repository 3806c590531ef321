#include "sim/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "sim/broad_phase/bins.h"
#include "sim/broad_phase/layout.h"
#include "sim/contact/check.h"
#include "sim/device.h"
#include "sim/element/prepare.h"
#include "sim/joint/check.h"
#include "sim/shape/check.h"
#include "sim/world/check.h"

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

/// Interleaves the lowest ten bits of three numbers: neighbours in space get close numbers (Morton 1966).
std::uint32_t interleaved(Index x, Index y, Index z) {
  std::uint32_t code = 0;
  for (int bit = 0; bit < 10; ++bit)
    code |= (std::uint32_t(x >> bit & 1) << (3 * bit)) | (std::uint32_t(y >> bit & 1) << (3 * bit + 1)) |
            (std::uint32_t(z >> bit & 1) << (3 * bit + 2));
  return code;
}

/// Index in the scene -> index in spatial order.
std::vector<BodyIndex> spatial_order(const SceneWorld& world, const WorldParameters& p) {
  const std::size_t count = world.body.size();
  std::vector<std::uint32_t> code(count);
  for (std::size_t b = 0; b < count; ++b) {
    const BinCoordinates bin = bin_of(p, world.body[b].position);
    code[b] = interleaved(bin.x, bin.y, bin.z);
  }
  std::vector<BodyIndex> sorted(count), place(count);
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(), [&](BodyIndex a, BodyIndex b) { return code[a] < code[b]; });
  for (std::size_t k = 0; k < count; ++k) place[sorted[k]] = BodyIndex(k);
  return place;
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
    if (follows_velocity(c)) c.body = place[c.body];
  for (Monitor& m : r.monitor) m.body = place[m.body];
  return r;
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

/// Bodies, shapes and bins of all worlds are each counted by one Index, and so are the contacts made room for.
void check_totals(const std::vector<FlatWorld>& worlds, const WorldSize& room) {
  double bodies = 0, contacts = 0, bins = 0;
  for (const FlatWorld& world : worlds) {
    bodies += std::max(world.size().bodies, room.bodies);
    contacts += 4.0 * std::max(world.size().shapes, room.shapes);
    bins += std::max(world.size().bins, room.bins);
  }
  const std::pair<const char*, double> totals[] = {
      {"bodies", bodies}, {"places for contacts", contacts}, {"bins", bins}};
  for (const auto& [name, count] : totals)
    if (count >= std::numeric_limits<Index>::max())
      throw InputError("the batch needs " + std::to_string(std::int64_t(count)) + " " + name + ", more than " +
                       std::to_string(std::numeric_limits<Index>::max()) + "; use fewer worlds");
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
  check_world(given, std::size_t(w));
  check_mechanisms(given, in_world(std::size_t(w)));
  check_elements(given, std::size_t(w), settings);
  SceneWorld scene_world = given;
  set_surface_sizes(scene_world);
  FlatWorld flat;
  flat.world = world_parameters(scene_world, settings, std::size_t(w));
  flat.place_of_body = spatial_order(scene_world, flat.world);
  const SceneWorld world = reordered(scene_world, flat.place_of_body);
  flat.world.body_count = Index(world.body.size());
  flat.body = world.body;
  flat.mesh = world.mesh;
  flat.heightfield = world.heightfield;
  flat.mechanisms = flatten_mechanisms(world, in_world(std::size_t(w)));
  flat.element = flat_elements(world, settings);
  append_shapes(world, binned_radius(world, settings), flat);
  append_masses(world, flat);
  check_pairs(flat, w);
  if (given.overlap_limit > 0) check_overlaps(flat, w, settings, given.overlap_limit);
  return flat;
}

void require_backend(Backend backend) {
  if (backend == Backend::cuda) require_cuda_device();
}

std::string description(const Fault& fault, double step) {
  if (fault.flags == 0) return {};
  char at[64];
  std::snprintf(at, sizeof at, "body %d in step %d (at %g s)", fault.body, fault.step, fault.step * step);
  std::string text = at;
  const char* joint = " ";
  for (const auto& [flag, what] : {std::pair{flag_not_finite, "has a velocity or place that is no number"},
                                   {flag_too_fast, "crosses more than a bin in a step"},
                                   {flag_left_domain, "has left the domain"}}) {
    if ((fault.flags & flag) == 0) continue;
    text += joint;
    text += what;
    joint = ", ";
  }
  return text;
}

std::unique_ptr<Simulation> make_simulation(Backend backend, const Scene& scene, const StepSettings& settings,
                                            int threads, const WorldSize& room) {
  require_backend(backend);
  if (scene.empty()) throw InputError("the scene has no worlds");
  check_settings(settings);
  std::vector<FlatWorld> worlds;
  for (std::size_t w = 0; w < scene.size(); ++w) worlds.push_back(flatten(scene[w], WorldIndex(w), settings));
  check_totals(worlds, room);
#ifdef GONOGO_WITH_CUDA
  if (backend == Backend::cuda) return make_cuda_simulation(std::move(worlds), settings, room);
#endif
  return make_cpu_simulation(std::move(worlds), settings, room, threads);
}

}  // namespace gonogo::sim
