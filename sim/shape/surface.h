// Surfaces of triangles for kernels: meshes and heightfields. Both offer
//   vertex(t, k), neighbour(t, k): corners of triangle t, and the triangle across the edge from corner k to the next
//   (-1 at a rim); place(v): where a vertex is [m, the shape's axes]; name(t): a number shared by coplanar neighbours,
//   so that a contact keeps its name while it crosses the edges of a flat face; visit_near(low, high, visit).
// Triangles run counterclockwise seen from outside (above).
#pragma once
#include "base/view.h"

namespace gonogo::sim {

struct MeshTriangle {
  Index vertex[3];
  Index neighbour[3];
  Index name;
  Index marks;  // of corners and edges k = 0, 1, 2: see MeshMark
};

/// Bits of MeshTriangle::marks for corner or edge 0; shifted by k for the others. Vertices in a flat face or on a
/// straight edge are not sharp: the corners and edges around them make their contacts.
struct MeshMark {
  static constexpr Index first = 1;     // this is the first triangle that has the vertex
  static constexpr Index sharp = 8;     // first, and the vertex lies neither in a flat face nor on a straight edge
  static constexpr Index ridge = 64;    // the edge is a ridge or rim, and this the first of its triangles
  static constexpr Index valley = 512;  // the solid is hollow along the edge
};

/// Node of a tree of boxes, stored depth first. A walk continues with the next node, or with `skip` to leave the box
/// out. It needs no stack, so the depth is not limited.
struct MeshNode {
  Vec3 low;
  Index first = 0;  // triangles of a leaf
  Vec3 high;
  Index count = 0;  // 0: not a leaf
  Index skip = 0;

  GONOGO_HD bool meets(const Vec3& from, const Vec3& to) const {
    return low.x <= to.x && high.x >= from.x && low.y <= to.y && high.y >= from.y && low.z <= to.z && high.z >= from.z;
  }
};

/// Cone around the outward normals of a node's triangles and of their neighbours. Its half angle is below 90 degrees; a
/// cosine of zero means any direction, and there may be a rim.
struct alignas(16) NormalCone {
  Vec3 axis;        // unit, in the mesh's axes
  Real cosine = 0;  // of the half angle; negative: -cosine is, and there is a valley among the triangles
};

/// One mesh in the arrays of a batch; indices inside a mesh count from its own beginning.
struct MeshRange {
  Index node = 0, node_count = 0, triangle = 0, vertex = 0;
  Index open = 0;  // 1: one-sided ground instead of the boundary of a solid
  Vec3 low, high;  // [m]
};

struct FieldRange {
  Index height = 0, name = 0;  // beginnings in the arrays
  Index nx = 0, ny = 0;        // heights along x and y
  Real spacing_x = 0, spacing_y = 0;
  Real low = 0, high = 0;  // least and largest height [m]
};

/// A mesh of the batch.
struct MeshSurface {
  const MeshRange& range;
  const MeshNode* node;
  const MeshTriangle* triangle;
  const Vec3* corner;
  const NormalCone* cone = nullptr;  // [node]

  GONOGO_HD Index vertex(Index t, int k) const { return triangle[t].vertex[k]; }
  GONOGO_HD Index neighbour(Index t, int k) const { return triangle[t].neighbour[k]; }
  GONOGO_HD Vec3d place(Index v) const { return static_cast<Vec3d>(corner[v]); }
  GONOGO_HD Index name(Index t) const { return triangle[t].name; }
  GONOGO_HD bool has(Index mark, Index t, int k) const { return (triangle[t].marks & (mark << k)) != 0; }

  /// Calls visit(t) for the triangles of the leaves for which, and for whose parents, `wanted`(node).
  template <class Wanted, class Visit>
  GONOGO_HD void visit_where(Wanted&& wanted, Visit&& visit) const {
    for (Index n = 0; n < range.node_count;) {
      const MeshNode& at = node[n];
      if (!wanted(at)) {
        n = at.skip;
        continue;
      }
      for (Index t = at.first; t < at.first + at.count; ++t) visit(t);
      ++n;
    }
  }

  /// Calls visit(t) for the triangles whose leaves' boxes meet the box from `low` to `high`.
  template <class Visit>
  GONOGO_HD void visit_near(const Vec3& low, const Vec3& high, Visit&& visit) const {
    visit_where([&](const MeshNode& at) { return at.meets(low, high); }, visit);
  }
};

/// A heightfield of the batch, centred on the shape's centre. Cells are cut along the diagonal from their lowest x and
/// y to their highest; triangle 2 c lies on the side of larger x.
struct FieldSurface {
  const FieldRange& range;
  const Real* height;
  const Index* names;

  GONOGO_HD Index cells_x() const { return range.nx - 1; }
  GONOGO_HD Index vertex(Index t, int k) const {
    const Index cell = t / 2, i = cell % cells_x(), j = cell / cells_x();
    const bool upper = t % 2 == 1;
    const Index right = k == 1 || (k == 2 && !upper) ? 1 : 0, up = k == 2 || (k == 1 && upper) ? 1 : 0;
    return (j + up) * range.nx + i + right;
  }
  GONOGO_HD Index neighbour(Index t, int k) const {
    const Index cell = t / 2, i = cell % cells_x(), j = cell / cells_x();
    if (t % 2 == 0) {
      if (k == 2) return t + 1;
      if (k == 1) return i + 1 < cells_x() ? 2 * (cell + 1) + 1 : -1;
      return j > 0 ? 2 * (cell - cells_x()) + 1 : -1;
    }
    if (k == 0) return t - 1;
    if (k == 1) return j + 2 < range.ny ? 2 * (cell + cells_x()) : -1;
    return i > 0 ? 2 * (cell - 1) : -1;
  }
  GONOGO_HD Vec3d place(Index v) const {
    const Index i = v % range.nx, j = v / range.nx;
    return {(i - 0.5 * (range.nx - 1)) * double(range.spacing_x), (j - 0.5 * (range.ny - 1)) * double(range.spacing_y),
            double(height[v])};
  }
  GONOGO_HD Index name(Index t) const { return names[t]; }

  /// Grid coordinates: 0 at the first height.
  GONOGO_HD double along_x(double x) const { return x / double(range.spacing_x) + 0.5 * (range.nx - 1); }
  GONOGO_HD double along_y(double y) const { return y / double(range.spacing_y) + 0.5 * (range.ny - 1); }

  /// Triangle above or below a point, or -1 outside of the grid.
  GONOGO_HD Index triangle_at(const Vec3d& p) const {
    const double x = along_x(p.x), y = along_y(p.y);
    if (!(x >= 0 && y >= 0 && x <= range.nx - 1 && y <= range.ny - 1)) return -1;
    const Index i = x < range.nx - 2 ? Index(x) : range.nx - 2, j = y < range.ny - 2 ? Index(y) : range.ny - 2;
    return 2 * (j * cells_x() + i) + (x - i >= y - j ? 0 : 1);
  }

  /// Calls visit(t) for the triangles of the cells that a box covers.
  template <class Visit>
  GONOGO_HD void visit_near(const Vec3& low, const Vec3& high, Visit&& visit) const {
    if (low.z > range.high || high.z < range.low) return;
    const Index i0 = cell_at(along_x(low.x), cells_x()), i1 = cell_at(along_x(high.x), cells_x());
    const Index j0 = cell_at(along_y(low.y), range.ny - 1), j1 = cell_at(along_y(high.y), range.ny - 1);
    if (along_x(high.x) < 0 || along_y(high.y) < 0 || along_x(low.x) > cells_x() || along_y(low.y) > range.ny - 1)
      return;
    for (Index j = j0; j <= j1; ++j)
      for (Index i = i0; i <= i1; ++i)
        for (Index side = 0; side < 2; ++side) visit(2 * (j * cells_x() + i) + side);
  }

  GONOGO_HD static Index cell_at(double x, Index count) { return !(x > 0) ? 0 : x < count ? Index(x) : count - 1; }
};

/// All meshes and heightfields of a batch.
struct SurfaceView {
  View<const MeshRange> mesh;
  View<const MeshNode> node;
  View<const NormalCone> cone;  // [node]
  View<const MeshTriangle> triangle;
  View<const Vec3> vertex;
  View<const FieldRange> field;
  View<const Real> height;
  View<const Index> name;

  GONOGO_HD MeshSurface mesh_at(Index i) const {
    const MeshRange& r = mesh[i];
    return {r, node.data + r.node, triangle.data + r.triangle, vertex.data + r.vertex, cone.data + r.node};
  }
  GONOGO_HD FieldSurface field_at(Index i) const {
    const FieldRange& r = field[i];
    return {r, height.data + r.height, name.data + r.name};
  }
};

}  // namespace gonogo::sim
