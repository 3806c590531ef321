#include "sim/scene/flat_world.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <string>

#include "base/error.h"
#include "sim/constraint/bins.h"
#include "sim/scene/check_scene.h"
#include "sim/scene/flat_elements.h"
#include "sim/scene/penalty_setup.h"
#include "sim/state/state.h"

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
  GONOGO_ASSERT(place.size() == world.body.size());
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
  GONOGO_ASSERT(next == world.shape.size() && flat.first_shape.size() == world.body.size());
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
  GONOGO_ASSERT(place.size() == list.size());
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
  if (is_penalty(settings.contact)) check_penalty(*scene, std::size_t(w), settings);
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

namespace {

constexpr Real kBinnedSizeRatio = 4;
/// So many shapes may stay out of the bins to make the bins at least so much narrower; those of similar size as the
/// others stay in.
constexpr std::size_t kFewLarge = 16;
constexpr Real kWorthwhile = 1.5, kSimilar = 1.25;

/// Bins of a world: this many whatever its shapes, and so many per binned shape.
constexpr double kMinBins = 4096, kBinsPerShape = 4;

bool is_finite(const Shape& s) { return s.type != ShapeType::plane && s.type != ShapeType::heightfield; }

/// Three bins must fit into a periodic side.
bool fits_period(const SceneWorld& world, Real radius, Real envelope) {
  const double width = 2 * double(radius) + envelope;
  return !(world.periodic_x && 3 * width > world.size.x) && !(world.periodic_y && 3 * width > world.size.y);
}

/// Largest sphere among those of similar size; 0 without spheres.
Real largest_grain(const SceneWorld& world) {
  Real least = std::numeric_limits<Real>::infinity(), largest = 0;
  for (const Shape& s : world.shape)
    if (s.type == ShapeType::sphere) least = std::min(least, s.size.x);
  for (const Shape& s : world.shape)
    if (s.type == ShapeType::sphere && s.size.x <= kBinnedSizeRatio * least) largest = std::max(largest, s.size.x);
  return largest;
}

struct Span {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

/// Where the binned shapes are at the start, without the offsets inside their bodies.
void find_spans(const SceneWorld& world, Real radius, Span (&span)[3]) {
  for (const Shape& s : world.shape) {
    if (!is_binned(s, radius)) continue;
    const Vec3d& x = world.body[s.body].position;
    const double at[3] = {x.x, x.y, x.z};
    for (int k = 0; k < 3; ++k) {
      span[k].low = std::min(span[k].low, at[k] - radius);
      span[k].high = std::max(span[k].high, at[k] + radius);
    }
  }
}

/// The whole domain where that takes few bins, otherwise the region of the shapes; fewer where even that is too much.
void choose_counts(const SceneWorld& world, double width, Real radius, double max_bins, Index (&bins)[3]) {
  const double size[3] = {world.size.x, world.size.y, world.size.z};
  const bool periodic[3] = {world.periodic_x, world.periodic_y, false};
  double count[3];
  for (int k = 0; k < 3; ++k) count[k] = std::max(3.0, std::floor(size[k] / width) + (periodic[k] ? 0 : 1));
  if (count[0] * count[1] * count[2] > max_bins) {
    Span span[3];
    find_spans(world, radius, span);
    for (int k = 0; k < 3; ++k)
      count[k] = std::min(count[k], std::max(3.0, std::ceil((span[k].high - span[k].low) / width) + 4));
  }
  while (count[0] * count[1] * count[2] > max_bins) {
    double& largest = *std::max_element(count, count + 3);
    largest = std::max(3.0, std::floor(0.8 * largest));
  }
  for (int k = 0; k < 3; ++k) bins[k] = Index(count[k]);
}

}  // namespace

bool is_binned(const Shape& s, Real binned_radius) { return is_finite(s) && bounding_radius(s) <= binned_radius; }

Real binned_radius(const SceneWorld& world, const StepSettings& settings) {
  std::vector<Real> radius;
  for (const Shape& s : world.shape)
    if (is_finite(s)) radius.push_back(bounding_radius(s));
  if (radius.empty()) return 0;
  std::sort(radius.begin(), radius.end());
  const auto within = std::upper_bound(radius.begin(), radius.end(), kBinnedSizeRatio * radius.front());
  auto limit = *(within - 1);
  if (std::size_t(within - radius.begin()) > kFewLarge) {
    const Real without = *(within - 1 - kFewLarge);
    if (limit > kWorthwhile * without)
      limit = *(std::upper_bound(radius.begin(), radius.end(), kSimilar * without) - 1);
  }
  // What does not fit into a short periodic side stays out of its bins.
  while (!fits_period(world, limit, settings.envelope)) {
    const auto smaller = std::lower_bound(radius.begin(), radius.end(), limit);
    if (smaller == radius.begin()) return 0;
    limit = *(smaller - 1);
  }
  return limit;
}

void lay_out_bins(const SceneWorld& world, const StepSettings& settings, std::size_t w, WorldParameters& p) {
  const Real radius = binned_radius(world, settings);
  const auto binned =
      std::count_if(world.shape.begin(), world.shape.end(), [&](const Shape& s) { return is_binned(s, radius); });
  if (!fits_period(world, largest_grain(world), settings.envelope))
    throw InputError("world " + std::to_string(w) +
                     ": a periodic side is shorter than three grains; make the bed larger or the grains smaller");
  if (binned == 0) {
    p.bins[0] = p.bins[1] = p.bins[2] = 3;
    p.bin_size = {Real(world.size.x / 3), Real(world.size.y / 3), Real(world.size.z / 3)};
    return;
  }
  const double width = 2 * double(radius) + settings.envelope;
  choose_counts(world, width, radius, std::max(kMinBins, kBinsPerShape * double(binned)), p.bins);
  // Bins tile a periodic side; elsewhere they have the least width and repeat.
  p.bin_size = {Real(world.periodic_x ? world.size.x / p.bins[0] : width),
                Real(world.periodic_y ? world.size.y / p.bins[1] : width), Real(width)};
}

namespace {

/// Interleaves the lowest ten bits of three numbers: neighbours in space get close numbers.
std::uint32_t interleaved(const BinCoordinates& bin) {
  std::uint32_t code = 0;
  for (int bit = 0; bit < 10; ++bit)
    code |= (std::uint32_t(bin.x >> bit & 1) << (3 * bit)) | (std::uint32_t(bin.y >> bit & 1) << (3 * bit + 1)) |
            (std::uint32_t(bin.z >> bit & 1) << (3 * bit + 2));
  return code;
}

constexpr double kCellsAlong = 1023;  // ten bits

/// Place of each in ascending order of its code.
std::vector<Index> places_along(const std::vector<BinCoordinates>& bin) {
  std::vector<std::uint32_t> code;
  for (const BinCoordinates& b : bin) code.push_back(interleaved(b));
  std::vector<Index> sorted(bin.size()), place(bin.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(), [&](Index a, Index b) { return code[a] < code[b]; });
  for (std::size_t k = 0; k < bin.size(); ++k) place[sorted[k]] = Index(k);
  return place;
}

/// Fewer successors than this share of what sorting would bring, and bodies are sorted anew.
constexpr double kMinOrder = 0.8;

bool are_beside(const BinCoordinates& a, const BinCoordinates& b) {
  return std::abs(a.x - b.x) <= 1 && std::abs(a.y - b.y) <= 1 && std::abs(a.z - b.z) <= 1;
}

std::size_t beside_their_successor(const std::vector<BinCoordinates>& bin) {
  std::size_t count = 0;
  for (std::size_t b = 1; b < bin.size(); ++b) count += are_beside(bin[b - 1], bin[b]);
  return count;
}

}  // namespace

std::vector<BodyIndex> spatial_order(const std::vector<Vec3d>& position, const WorldParameters& world) {
  std::vector<BinCoordinates> bin;
  for (const Vec3d& x : position) bin.push_back(bin_of(world, x));
  return places_along(bin);
}

std::vector<Index> order_along_curve(const std::vector<Vec3d>& position) {
  Vec3d low = position.at(0), high = low;
  for (const Vec3d& x : position) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  const double cell = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-9}) / kCellsAlong;
  std::vector<BinCoordinates> bin;
  for (const Vec3d& x : position)
    bin.push_back({Index((x.x - low.x) / cell), Index((x.y - low.y) / cell), Index((x.z - low.z) / cell)});
  return places_along(bin);
}

bool have_mixed(const std::vector<Vec3d>& position, const std::vector<BodyIndex>& place, const WorldParameters& world) {
  std::vector<BinCoordinates> bin(position.size()), sorted(position.size());
  for (std::size_t b = 0; b < bin.size(); ++b) bin[b] = sorted[place[b]] = bin_of(world, position[b]);
  return double(beside_their_successor(bin)) < kMinOrder * double(beside_their_successor(sorted));
}

std::vector<BodyIndex> composed(const std::vector<BodyIndex>& first, const std::vector<BodyIndex>& second) {
  std::vector<BodyIndex> both;
  for (const BodyIndex place : first) both.push_back(second[place]);
  return both;
}

}  // namespace gonogo::sim
