// Shapes that are not binned: where each of them reaches, so that nearly every other shape is told by a few comparisons
// that it is elsewhere.
#pragma once
#include "sim/shape/convex.h"
#include "sim/shape/surface.h"
#include "sim/world/state.h"

namespace gonogo::sim {

/// Large shape l -> its box along the world's axes, or the half space below a plane.
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
      place(box, q, {-x, -y, f.low - (x + y)}, {x, y, f.high});  // so deep below the ground shapes are pushed out of it
      return;
    }
    box.half = half_extents(s, q);
    if (s.type == ShapeType::plane) box.up = rotate(q, {0, 0, 1});
  }

  /// The box around a box with sides along the axes of `q`.
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

}  // namespace gonogo::sim
