// Bounding boxes of the shapes that are not binned, which rule out nearly every pair by a few comparisons. In a world
// with many of them, groups of eight share a box, eight such groups a larger one, and so on; the list follows a
// space-filling curve, so groups are compact. A search skips the boxes that it does not reach. It keeps the list's
// order, so boxes change no bits.
#pragma once
#include "sim/shape/convex.h"
#include "sim/shape/surface.h"
#include "sim/state/state.h"

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

}  // namespace gonogo::sim
