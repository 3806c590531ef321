// Corners, edges and faces of meshes and convex bodies for contacts, in world axes about the centre of the pair's first
// shape.
//
// Two features touch along a direction in which both are furthest; `supports` tests that. A body that leans by less
// than kLean still touches with its whole face or edge, each point with its own gap. `lean`: sine of the angle by which
// the direction may miss.
#pragma once
#include "sim/shape/convex.h"
#include "sim/shape/surface_touch.h"

namespace gonogo::sim {

inline constexpr Real kLean = kLevel, kStrict = Real(1e-3);  // sines; the first of 10 degrees

/// A mesh of the batch turned and shifted; a surface like the mesh itself.
struct PlacedMesh {
  MeshSurface mesh;
  Quat q;        // from the mesh's axes to the world's
  Vec3d centre;  // [m]

  GONOGO_HD Index vertex(Index t, int k) const { return mesh.vertex(t, k); }
  GONOGO_HD Index neighbour(Index t, int k) const { return mesh.neighbour(t, k); }
  GONOGO_HD Vec3d place(Index v) const { return in_frame(conjugate(q), mesh.place(v)) + centre; }
  GONOGO_HD Index name(Index t) const { return mesh.name(t); }
  GONOGO_HD bool has(Index mark, Index t, int k) const { return mesh.has(mark, t, k); }

  /// Half of a box's sides after a turn.
  GONOGO_HD static Vec3 turned_half(const Quat& turn, const Vec3& half) {
    const Vec3 x = rotate(turn, {half.x, 0, 0}), y = rotate(turn, {0, half.y, 0}), z = rotate(turn, {0, 0, half.z});
    return {std::fabs(x.x) + std::fabs(y.x) + std::fabs(z.x), std::fabs(x.y) + std::fabs(y.y) + std::fabs(z.y),
            std::fabs(x.z) + std::fabs(y.z) + std::fabs(z.z)};
  }

  /// Calls visit(t) for the triangles whose leaves may meet a box.
  template <class Visit>
  GONOGO_HD void visit_near(const Vec3& low, const Vec3& high, Visit&& visit) const {
    Vec3 own_low, own_high;
    own_box(low, high, own_low, own_high);
    mesh.visit_near(own_low, own_high, visit);
  }

  /// The same, without the nodes that `facing` rules out.
  template <class Facing, class Visit>
  GONOGO_HD void visit_facing(const Vec3& low, const Vec3& high, const Facing& facing, Visit&& visit) const {
    Vec3 own_low, own_high;
    own_box(low, high, own_low, own_high);
    mesh.visit_where([&](const MeshNode& at) { return at.meets(own_low, own_high) && facing.wants(at); }, visit);
  }

  /// The box along the mesh's axes around a box along the world's.
  GONOGO_HD void own_box(const Vec3& low, const Vec3& high, Vec3& own_low, Vec3& own_high) const {
    const Vec3 half = turned_half(conjugate(q), (high - low) * Real(0.5));
    const Vec3 middle = static_cast<Vec3>(in_frame(q, static_cast<Vec3d>((low + high) * Real(0.5)) - centre));
    own_low = middle - half;
    own_high = middle + half;
  }

  /// The box around all of it.
  GONOGO_HD void bounds(Vec3& low, Vec3& high) const {
    const MeshRange& r = mesh.range;
    const Vec3 half = turned_half(q, (r.high - r.low) * Real(0.5));
    const Vec3 middle = static_cast<Vec3>(in_frame(conjugate(q), static_cast<Vec3d>(r.low + r.high) * 0.5) + centre);
    low = middle - half;
    high = middle + half;
  }
};

/// A placed mesh seen from the origin. Directions are computed in the mesh's own axes, because they need no
/// position.
struct MeshFrom : SurfaceFrom<PlacedMesh> {
  GONOGO_HD const Vec3& own_corner(Index t, int k) const { return surface.mesh.corner[surface.vertex(t, k)]; }

  GONOGO_HD Vec3 normal(Index t) const {
    const Vec3& a = own_corner(t, 0);
    const Vec3 n = cross(own_corner(t, 1) - a, own_corner(t, 2) - a);
    return rotate(surface.q, n * (1 / length(n)));
  }

  /// Whether a corner is the furthest in direction `n` among its neighbours.
  GONOGO_HD bool supports(Index t, int k, const Vec3& n, Real lean) const {
    const Vec3 own = rotate_back(surface.q, n), here = own_corner(t, k);
    bool furthest = true;
    visit_ring(t, k, [&](Index r, int c) {
      for (int i = 1; i < 3; ++i) {
        const Vec3 edge = own_corner(r, (c + i) % 3) - here;
        furthest = furthest && dot(edge, own) <= lean * length(edge);
      }
    });
    return furthest;
  }
};

/// An edge of a solid; `inward` and `beyond`: unit, square to it, into the two faces beside it.
struct Edge {
  Vec3 start, along, inward, beyond;

  GONOGO_HD bool is_outer(const Vec3& n, Real lean) const { return dot(n, inward) <= lean && dot(n, beyond) <= lean; }
  GONOGO_HD bool supports(const Vec3& n, Real lean) const {
    return is_outer(n, lean) && std::fabs(dot(n, along)) <= lean * length(along);
  }
};

/// A ridge or rim; beyond a rim the solid is taken to continue straight down.
GONOGO_HD inline Edge mesh_edge(const MeshFrom& from, Index t, int k) {
  const Vec3 start = from.corner(t, k), along = from.corner(t, (k + 1) % 3) - start;
  const Vec3 n = from.normal(t), inward = cross(n, along);
  const Index other = from.surface.neighbour(t, k);
  const Vec3 beyond = other < 0 ? -n * length(along) : cross(along, from.normal(other));
  return {start, along, inward * (1 / length(along)), beyond * (1 / length(along))};
}

/// Whether a point on a box's or cylinder's surface is the furthest of the body.
GONOGO_HD inline bool point_supports(const Convex& c, const Vec3& p, const Vec3& direction, Real slack, Real lean) {
  const Vec3 x = c.into(p - c.centre), n = c.into(direction);
  const auto side = [&](Real at, Real half, Real toward) {
    if (std::fabs(at) < half - slack) return std::fabs(toward) <= lean;
    return (at > 0 ? toward : -toward) >= -lean;
  };
  if (!side(x.y, c.size.y, n.y)) return false;
  if (c.type == ShapeType::box) return side(x.x, c.size.x, n.x) && side(x.z, c.size.z, n.z);
  const Real r = std::sqrt(x.x * x.x + x.z * x.z);
  if (r < c.size.x - slack) return n.x * n.x + n.z * n.z <= lean * lean;
  return x.x * n.x + x.z * n.z >= -lean * r && std::fabs(x.x * n.z - x.z * n.x) <= lean * r;
}

/// Sides of a box or cylinder nearest to a point: outward normals, and distances outside of them.
struct Sides {
  int count = 0;
  Vec3 normal[3];
  Real gap[3];
  GONOGO_HD void add(const Vec3& n, Real g) {
    normal[count] = n;
    gap[count++] = g;
  }
};

GONOGO_HD inline Sides sides_at(const Convex& c, const Vec3& p) {
  const Vec3 x = c.into(p - c.centre);
  const auto flat = [&](int k, Real at, Real half, Sides& s) {
    s.add(at < 0 ? -c.axis[k] : c.axis[k], std::fabs(at) - half);
  };
  Sides s;
  flat(1, x.y, c.size.y, s);
  if (c.type == ShapeType::box) {
    flat(0, x.x, c.size.x, s);
    flat(2, x.z, c.size.z, s);
    return s;
  }
  const Real r = std::sqrt(x.x * x.x + x.z * x.z);
  s.add(r > 0 ? c.out_of({x.x / r, 0, x.z / r}) : c.axis[0], r - c.size.x);
  return s;
}

/// Name of a contact inside a pair: a 31-bit hash of two features.
GONOGO_HD inline int feature_name(std::uint32_t kind, std::uint32_t of_a, std::uint32_t of_b) {
  std::uint32_t h = (kind + 1) * 0x9E3779B9u;
  for (const std::uint32_t x : {of_a, of_b}) {
    h = (h ^ x) * 0x85EBCA6Bu;
    h ^= h >> 15;
    h *= 0xC2B2AE35u;
    h ^= h >> 13;
  }
  return int(h & 0x7FFFFFFFu);
}

}  // namespace gonogo::sim
