// Surfaces of triangles for kernels: meshes and heightfields. Both offer
//   vertex(t, k), neighbour(t, k): corners of triangle t, and the triangle across the edge from corner k to the next
//   (-1 at a rim); place(v): where a vertex is [m, the shape's axes]; name(t): a number shared by coplanar neighbours,
//   so that a contact keeps its name while it crosses the edges of a flat face; visit_near(low, high, visit).
// Triangles run counterclockwise seen from outside (above).
#pragma once
#include "base/parallel/buffer.h"

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
      GONOGO_ASSERT(at.skip > n && at.skip <= range.node_count && at.count >= 0);
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
    GONOGO_ASSERT(t >= 0 && t < 2 * cells_x() * (range.ny - 1) && k >= 0 && k < 3);
    const Index cell = t / 2, i = cell % cells_x(), j = cell / cells_x();
    const bool upper = t % 2 == 1;
    const Index right = k == 1 || (k == 2 && !upper) ? 1 : 0, up = k == 2 || (k == 1 && upper) ? 1 : 0;
    return (j + up) * range.nx + i + right;
  }
  GONOGO_HD Index neighbour(Index t, int k) const {
    GONOGO_ASSERT(t >= 0 && t < 2 * cells_x() * (range.ny - 1) && k >= 0 && k < 3);
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
    GONOGO_ASSERT(v >= 0 && v < range.nx * range.ny);
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

/// Nearest point of a triangle to the origin. feature: 0 face, 1 + k the edge from corner k, 4 + k the corner.
struct OnTriangle {
  Vec3 point;
  int feature;
};

/// Ericson, Real-Time Collision Detection (2005), 5.1.5, with the point at the origin.
GONOGO_HD inline OnTriangle nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const Real d1 = -dot(ab, a), d2 = -dot(ac, a);
  if (d1 <= 0 && d2 <= 0) return {a, 4};
  const Real d3 = -dot(ab, b), d4 = -dot(ac, b);
  if (d3 >= 0 && d4 <= d3) return {b, 5};
  const Real vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + ab * (d1 / (d1 - d3)), 1};
  const Real d5 = -dot(ab, c), d6 = -dot(ac, c);
  if (d6 >= 0 && d5 <= d6) return {c, 6};
  const Real vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + ac * (d2 / (d2 - d6)), 3};
  const Real va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), 2};
  const Vec3 n = cross(ab, ac);
  return {n * (dot(a, n) / dot(n, n)), 0};  // foot of the perpendicular: exact where weights of corners would cancel
}

/// A surface seen from a point: positions are relative to it, so that a float resolves the gap.
template <class Surface>
struct SurfaceFrom {
  const Surface& surface;
  Vec3d origin;

  GONOGO_HD Vec3 corner(Index t, int k) const { return at(surface.vertex(t, k)); }
  GONOGO_HD Vec3 at(Index vertex) const { return static_cast<Vec3>(surface.place(vertex) - origin); }

  GONOGO_HD Vec3 normal(Index t) const {
    const Vec3 a = corner(t, 0), n = cross(corner(t, 1) - a, corner(t, 2) - a);
    return n * (1 / length(n));
  }

  GONOGO_HD OnTriangle nearest(Index t) const { return nearest_on_triangle(corner(t, 0), corner(t, 1), corner(t, 2)); }

  /// From the edge of `t` after corner k into the triangle across it, square to the edge; zero at a rim.
  GONOGO_HD Vec3 across(Index t, int k) const {
    const Index other = surface.neighbour(t, k);
    if (other < 0) return {};
    const Vec3 from = corner(t, k), edge = corner(t, (k + 1) % 3) - from;
    Index far = 0;
    for (int i = 0; i < 3; ++i) {
      const Index v = surface.vertex(other, i);
      if (v != surface.vertex(t, k) && v != surface.vertex(t, (k + 1) % 3)) far = v;
    }
    const Vec3 in = at(far) - from;
    return in - edge * (dot(in, edge) / dot(edge, edge));
  }

  /// Sum of the normals beside the edge, which points outward.
  GONOGO_HD Vec3 edge_normal(Index t, int k) const {
    const Index other = surface.neighbour(t, k);
    return other < 0 ? normal(t) : normal(t) + normal(other);
  }

  GONOGO_HD int corner_of(Index t, Index vertex) const {
    return surface.vertex(t, 0) == vertex ? 0 : surface.vertex(t, 1) == vertex ? 1 : 2;
  }

  /// Calls visit(triangle, its corner) for the triangles around corner k of `t`, starting there.
  template <class Visit>
  GONOGO_HD void visit_ring(Index t, int k, Visit&& visit) const {
    const Index vertex = surface.vertex(t, k);
    visit(t, k);
    for (int way = 0; way < 2; ++way) {  // one way round; at a rim also the other way from the start
      Index now = t;
      for (int steps = 0; steps < 1000; ++steps) {
        const int c = corner_of(now, vertex);
        now = surface.neighbour(now, way == 0 ? (c + 2) % 3 : c);
        if (now == t) return;
        if (now < 0) break;
        visit(now, corner_of(now, vertex));
      }
    }
  }

  /// Sum of the normals around a corner, weighted by their angles, which decides inside or outside (Baerentzen & Aanaes
  /// 2005).
  GONOGO_HD Vec3 corner_normal(Index t, int k) const {
    Vec3 sum;
    visit_ring(t, k, [&](Index r, int c) {
      const Vec3 here = corner(r, c), u = corner(r, (c + 1) % 3) - here, v = corner(r, (c + 2) % 3) - here;
      const Real cosine = dot(u, v) / (length(u) * length(v));
      sum += normal(r) * std::acos(std::fmin(std::fmax(cosine, Real(-1)), Real(1)));
    });
    return sum;
  }

  GONOGO_HD Vec3 outward(Index t, int feature) const {
    return feature == 0 ? normal(t) : feature < 4 ? edge_normal(t, feature - 1) : corner_normal(t, feature - 4);
  }

  static constexpr Real kSlack = Real(1e-4);  // sine of an angle: rounding must not drop both of two neighbours

  /// Whether the distance has a local minimum at an edge or corner, met from this triangle first. `d`: from there to
  /// the point.
  GONOGO_HD bool is_local_minimum(Index t, int feature, const Vec3& d) const {
    if (feature == 0) return true;
    const Real size = length(d);
    if (feature < 4) {
      const Index other = surface.neighbour(t, feature - 1);
      const Vec3 in = across(t, feature - 1);
      return (other < 0 || t < other) && dot(d, in) <= kSlack * size * length(in);
    }
    bool first = true, minimum = true;
    visit_ring(t, feature - 4, [&](Index r, int c) {
      first = first && r >= t;
      for (int k = 1; k < 3; ++k) {
        const Vec3 edge = corner(r, (c + k) % 3) - corner(r, c);
        minimum = minimum && dot(d, edge) <= kSlack * size * length(edge);
      }
    });
    return first && minimum;
  }

  /// Names of contacts: 8 per triangle.
  GONOGO_HD int name(Index t, int feature) const { return feature == 0 ? 8 * surface.name(t) : 8 * t + feature; }
};

}  // namespace gonogo::sim
