// Broad phase: shapes sorted into bins. A bin is at least as wide as the largest binned shape plus the envelope, so
// touching shapes lie in the same or in adjacent bins. Each shape searches half of its neighbour bins, which meets
// every pair once.
// Bin coordinates count modulo the number of bins along each axis (at least three). So a few bins serve a large domain,
// and shapes outside of the domain cost no more than others. A test of distance drops pairs that share a bin from afar.
// Large shapes (ground, wheels, hulls) are not binned, see layout.h. Every shape tests those of its world, or the ones
// near it where there are many, see large.h.
#pragma once
#include "sim/contact/large.h"
#include "sim/state/period.h"

namespace gonogo::sim {

struct BinCoordinates {
  Index x, y, z;
};

GONOGO_HD inline Index bin_along(double offset, Real size, Index count) {
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
  return world.first_bin + (b.z * world.bins[1] + b.y) * world.bins[0] + b.x;
}

GONOGO_HD inline Index wrapped(Index bin, Index count) {
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

/// Rows that hold the half of the 27 bins around a shape that it searches.
inline constexpr Index kNeighbourRows = 5;

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
    if (bin >= 0) shape_in_bin[first_in_bin[bin] + atomic_increment(cursor[bin])] = i;
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
      item[j] = value;
    }
  }
};

template <class Exec>
void sort_into_bins(Exec exec, State<Exec>& s) {
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
