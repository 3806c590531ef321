// Broad phase: shapes sorted into bins. A bin is at least as wide as the largest binned shape plus the envelope, so
// touching shapes lie in the same or in adjacent bins. Each shape searches half of its neighbour bins, which meets
// every pair once.
// Bin coordinates count modulo the number of bins along each axis (at least three). So a few bins serve a large domain,
// and shapes outside of the domain cost no more than others. A test of distance drops pairs that share a bin from afar.
// Large shapes (ground, wheels, hulls) are not binned, see lay_out_bins(). Every shape tests those of its world, or,
// where there are many, the ones near it: groups of eight large shapes share a box, eight such groups a larger one, and
// so on. The list follows a space-filling curve, so groups are compact. A search skips the boxes that it does not reach
// and keeps the list's order, so boxes change no bits.
#pragma once
#include "sim/shape/surface.h"
#include "sim/shape/touch/convex.h"
#include "sim/state/state.h"
#include "sim/state/world.h"

namespace gonogo::sim {

/// Computes the box of large shape l along the world's axes, or the half space below a plane.
struct BoundLargeShape {
  View<const Shape> shape;
  View<const Vec3d> centre;
  View<const Quat> orientation;
  View<LargeShape> large;
  SurfaceView surfaces;

  static constexpr Real kEndless = Real(1e30);

  GONOGO_HD void operator()(Index l) const {
    LargeShape& box = large[l];
    const Shape& s = shape[box.shape];
    const Quat q = shape_orientation(s, orientation[s.body]);
    GONOGO_ASSERT(is_unit(q));
    box.middle = centre[box.shape];
    box.up = {};
    if (s.type == ShapeType::mesh) {
      const MeshRange& m = surfaces.mesh[s.surface];
      place(box, q, m.low, m.high);
      return;
    }
    if (s.type == ShapeType::heightfield) {
      const FieldRange& f = surfaces.field[s.surface];
      const Real x = Real(f.nx - 1) * f.spacing_x / 2, y = Real(f.ny - 1) * f.spacing_y / 2;
      place(box, q, {-x, -y, f.low - (x + y)}, {x, y, f.high});  // shapes are pushed out from this depth on
      return;
    }
    box.half = half_extents(s, q);
    if (s.type == ShapeType::plane) box.up = rotate(q, {0, 0, 1});
  }

  /// Sets the box around one with sides along the axes of `q`.
  GONOGO_HD static void place(LargeShape& box, const Quat& q, const Vec3& low, const Vec3& high) {
    const Vec3 half = (high - low) * Real(0.5);
    const Convex c = convex(ShapeType::box, half, {}, q);
    box.half = {extent(c, {1, 0, 0}), extent(c, {0, 1, 0}), extent(c, {0, 0, 1})};
    box.middle += static_cast<Vec3d>(rotate(q, (low + high) * Real(0.5)));
  }

  GONOGO_HD static Vec3 half_extents(const Shape& s, const Quat& q) {
    if (s.type == ShapeType::sphere) return {s.size.x, s.size.x, s.size.x};
    if (s.type == ShapeType::plane) return {kEndless, kEndless, kEndless};
    Vec3 size = s.size;
    if (s.type == ShapeType::wheel) size.x = lug_edge_radius(s);
    const Convex c = convex(s.type == ShapeType::wheel ? ShapeType::cylinder : s.type, size, {}, q);
    return {extent(c, {1, 0, 0}), extent(c, {0, 1, 0}), extent(c, {0, 0, 1})};
  }
};

/// Computes the box of group g around eight groups of the level below, or around eight large shapes.
struct BoundLargeGroup {
  View<const LargeShape> below;
  View<LargeShape> group;

  GONOGO_HD void operator()(Index g) const {
    Vec3d low{1e300, 1e300, 1e300}, high = -low;
    GONOGO_ASSERT(g * kLargeGroup < below.size);
    const Index end = g + 1 < group.size ? (g + 1) * kLargeGroup : below.size;
    for (Index k = g * kLargeGroup; k < end; ++k) {
      const Vec3d &m = below[k].middle, h = static_cast<Vec3d>(below[k].half);
      low = {std::fmin(low.x, m.x - h.x), std::fmin(low.y, m.y - h.y), std::fmin(low.z, m.z - h.z)};
      high = {std::fmax(high.x, m.x + h.x), std::fmax(high.y, m.y + h.y), std::fmax(high.z, m.z + h.z)};
    }
    group[g].middle = (low + high) * 0.5;
    group[g].half = static_cast<Vec3>((high - low) * (0.5 * kRoomy));
  }

  static constexpr double kRoomy = 1.00001;  // covers rounding to float
};

/// Calls visit(l) for the large shapes first .. last - 1, except those in a group whose box fails reaches(box). A group
/// may also hold shapes of other worlds, which only makes its box larger.
template <class Reaches, class Visit>
GONOGO_HD inline void visit_large_near(const LargeGroups& groups, Index first, Index last, Reaches&& reaches,
                                       Visit&& visit) {
  for (Index l = first; l < last;) {
    int level = 0;
    while (level < groups.levels && (l & ((kLargeGroup << (kLargeGroupBits * level)) - 1)) == 0) ++level;
    for (; level > 0; --level)
      if (!reaches(groups.box[groups.first[level - 1] + (l >> (kLargeGroupBits * level))])) break;
    if (level == 0)
      visit(l++);
    else
      l = ((l >> (kLargeGroupBits * level)) + 1) << (kLargeGroupBits * level);
  }
}

/// Makes room for the boxes of all groups; `max_per_world`: the largest number of large shapes in one world.
template <class Exec>
void reserve_large_groups(State<Exec>& s, Index large, Index max_per_world) {
  s.large_groups = {};
  Index total = 0;
  if (max_per_world >= kGroupedFrom)
    for (Index count = large; count > 1; ++s.large_groups.levels) {
      s.large_groups.first[s.large_groups.levels] = total;
      count = (count + kLargeGroup - 1) / kLargeGroup;
      total += count;
      s.large_groups.first[s.large_groups.levels + 1] = total;
    }
  GONOGO_ASSERT(s.large_groups.levels <= kMaxLargeLevels);
  s.large_group.fill_zero(total);
  s.large_groups.box = s.large_group.view();
}

/// Boxes of the large shapes where they are now, and of their groups.
template <class Exec>
void bound_large_shapes(Exec exec, State<Exec>& s) {
  for_each_index(
      exec, s.large.size(),
      BoundLargeShape{s.shape.view(), s.centre.view(), s.orientation.view(), s.large.view(), s.surfaces.view()});
  View<const LargeShape> below = s.large.view();
  for (int level = 0; level < s.large_groups.levels; ++level) {
    const Index first = s.large_groups.first[level], count = s.large_groups.first[level + 1] - first;
    const View<LargeShape> group{s.large_group.data() + first, count};
    for_each_index(exec, count, BoundLargeGroup{below, group});
    below = group;
  }
}

struct BinCoordinates {
  Index x, y, z;
};

GONOGO_HD inline Index bin_along(double offset, Real size, Index count) {
  GONOGO_ASSERT(size > 0 && count >= 3);
  const double bin = std::floor(offset / double(size));
  const double inside = bin >= 0 && bin < count ? bin : bin - count * std::floor(bin / count);
  return inside >= 0 && inside < count ? Index(inside) : 0;  // NaN: bin 0, so that a flagged world goes on
}

GONOGO_HD inline BinCoordinates bin_of(const WorldParameters& world, const Vec3d& centre) {
  return {bin_along(folded(centre.x, world.origin.x, world.period.x) - world.origin.x, world.bin_size.x, world.bins[0]),
          bin_along(folded(centre.y, world.origin.y, world.period.y) - world.origin.y, world.bin_size.y, world.bins[1]),
          bin_along(centre.z - world.origin.z, world.bin_size.z, world.bins[2])};
}

GONOGO_HD inline Index bin_index(const WorldParameters& world, const BinCoordinates& b) {
  GONOGO_ASSERT(b.x >= 0 && b.x < world.bins[0] && b.y >= 0 && b.y < world.bins[1] && b.z >= 0 && b.z < world.bins[2]);
  return world.first_bin + (b.z * world.bins[1] + b.y) * world.bins[0] + b.x;
}

GONOGO_HD inline Index wrapped(Index bin, Index count) {
  GONOGO_ASSERT(bin >= -count && bin < 2 * count);
  return bin < 0 ? bin + count : bin >= count ? bin - count : bin;
}

/// Bins x + from .. x + to of one row.
template <class Visit>
GONOGO_HD inline void visit_row(const WorldParameters& world, const BinCoordinates& b, Index from, Index to,
                                bool shared, Visit&& visit) {
  const Index count = world.bins[0];
  const Index row = bin_index(world, {0, wrapped(b.y, world.bins[1]), wrapped(b.z, world.bins[2])});
  const Index low = b.x + from, high = b.x + to;
  visit(row + (low < 0 ? 0 : low), row + (high >= count ? count : high + 1), shared);
  if (low < 0) visit(row + low + count, row + low + count + 1, false);
  if (high >= count) visit(row + high - count, row + high - count + 1, false);
}

/// Calls visit(first, last, shared) for ranges of consecutive bins of one of these rows, `last` excluded. `shared`: the
/// range starts with the shape's own bin.
template <class Visit>
GONOGO_HD inline void visit_neighbour_row(const WorldParameters& world, const BinCoordinates& b, Index row,
                                          Visit&& visit) {
  if (row == 0) return visit_row(world, b, 0, 1, true, visit);
  const Index dy = row == 1 ? 1 : row - 3, dz = row == 1 ? 0 : 1;
  visit_row(world, {b.x, b.y + dy, b.z + dz}, -1, 1, false, visit);
}

/// Shape i -> its centre in the world and its bin (-1 for large shapes).
struct PlaceShape {
  View<const Shape> shape;
  View<const Vec3d> position;
  View<const Quat> orientation;
  View<const WorldIndex> world_of_body;
  View<const WorldParameters> world;
  View<Vec3d> centre;
  View<Index> bin_of_shape;  // holds -1 for large shapes already
  View<Index> bin_size;

  GONOGO_HD void operator()(Index i) const {
    const Shape& s = shape[i];
    Vec3d c = position[s.body];
    if (s.offset_B.x != 0 || s.offset_B.y != 0 || s.offset_B.z != 0)
      c += static_cast<Vec3d>(rotate(orientation[s.body], s.offset_B));
    centre[i] = c;
    if (bin_of_shape[i] < 0) return;
    const WorldParameters& w = world[world_of_body[s.body]];
    const Index bin = bin_index(w, bin_of(w, c));
    bin_of_shape[i] = bin;
    atomic_increment(bin_size[bin]);
  }
};

struct FillBin {
  View<const Index> bin_of_shape, first_in_bin;
  View<Index> cursor;
  View<ShapeIndex> shape_in_bin;

  GONOGO_HD void operator()(Index i) const {
    const Index bin = bin_of_shape[i];
    if (bin < 0) return;
    const Index at = first_in_bin[bin] + atomic_increment(cursor[bin]);
    GONOGO_ASSERT(at < first_in_bin[bin + 1]);
    shape_in_bin[at] = i;
  }
};

struct CopyBinnedShape {
  View<const Shape> shape;
  View<const Vec3d> centre;
  View<const WorldIndex> world_of_body;
  View<const WorldParameters> world;
  View<const ShapeIndex> shape_in_bin;
  View<BinnedShape> shape_by_bin;

  GONOGO_HD void operator()(Index k) const {
    const ShapeIndex i = shape_in_bin[k];
    GONOGO_ASSERT(shape[i].type != ShapeType::plane && shape[i].type != ShapeType::heightfield);  // never binned
    const WorldParameters& w = world[world_of_body[shape[i].body]];
    const Vec3d c = centre[i];
    shape_by_bin[k] = {
        {folded(c.x, w.origin.x, w.period.x), folded(c.y, w.origin.y, w.period.y), c.z}, bounding_radius(shape[i]), i};
  }
};

/// Sorts the items of a segment, which threads filled in any order.
struct SortSegment {
  View<const Index> first;
  View<Index> item;

  GONOGO_HD void operator()(Index segment) const {
    for (Index i = first[segment] + 1; i < first[segment + 1]; ++i) {
      const Index value = item[i];
      Index j = i;
      for (; j > first[segment] && item[j - 1] > value; --j) item[j] = item[j - 1];
      GONOGO_ASSERT(j == first[segment] || item[j - 1] < value);  // each item once
      item[j] = value;
    }
  }
};

template <class Exec>
void sort_into_bins(Exec exec, State<Exec>& s) {
  GONOGO_ASSERT(s.bin_cursor.size() == s.bin_count && s.first_in_bin.size() == s.bin_count + 1);
  GONOGO_ASSERT(s.shape_in_bin.size() == s.shape_count && s.centre.size() == s.shape_count);
  clear(exec, s.bin_cursor.view());
  for_each_index(exec, s.shape_count,
                 PlaceShape{.shape = s.shape.view(),
                            .position = s.position.view(),
                            .orientation = s.orientation.view(),
                            .world_of_body = s.world_of_body.view(),
                            .world = s.world.view(),
                            .centre = s.centre.view(),
                            .bin_of_shape = s.bin_of_shape.view(),
                            .bin_size = s.bin_cursor.view()});
  exclusive_scan(exec, s.bin_cursor.view(), s.first_in_bin.view(), s.scratch);
  clear(exec, s.bin_cursor.view());
  for_each_index(exec, s.shape_count,
                 FillBin{s.bin_of_shape.view(), s.first_in_bin.view(), s.bin_cursor.view(), s.shape_in_bin.view()});
  for_each_index(exec, s.bin_count, SortSegment{s.first_in_bin.view(), s.shape_in_bin.view()});
  const Counted binned{s.shape_count, s.first_in_bin.data() + s.bin_count};
  for_each_counted(exec, binned,
                   CopyBinnedShape{s.shape.view(), s.centre.view(), s.world_of_body.view(), s.world.view(),
                                   s.shape_in_bin.view(), s.shape_by_bin.view()});
  bound_large_shapes(exec, s);
}

}  // namespace gonogo::sim
