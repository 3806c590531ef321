// Corners, edges and faces of meshes and convex bodies for contacts, in world axes about the centre of the pair's first
// shape.
//
// Two features touch along a direction in which both are furthest; `supports` tests that. A body that leans by less
// than kLean still touches with its whole face or edge, each point with its own gap. `lean`: sine of the angle by which
// the direction may miss.
//
// Also where a point of another body leaves a mesh: through the faces below it that the body presses on. Beside a
// convex edge that is the face with the smallest overlap; in a hollow it is every face.
#pragma once
#include "sim/shape/touch/convex.h"
#include "sim/shape/touch/surface_touch.h"

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

/// Tolerances of contacts with meshes [m].
struct Tolerance {
  Real envelope;  // contacts are found up to this gap
  Real slack;     // 1e-4 of the smaller body: shorter lengths may be rounding
  Real limit;     // deeper points are ignored
};

/// `half`: half of the smallest side of the smaller body; `share`: limit / half.
GONOGO_HD inline Tolerance tolerance_for(Real half, Real share, Real envelope) {
  return {envelope, Real(1e-4) * half, std::fmax(share * half, envelope)};
}

/// Whether the foot of a point lies in triangle t, whose normal is `n`, or beyond a valley's edge by up to `hollow`.
GONOGO_HD inline bool is_over(const MeshFrom& from, Index t, const Vec3& n, const Vec3& p, Real slack, Real hollow) {
  for (int k = 0; k < 3; ++k) {
    const Vec3 start = from.corner(t, k), edge = from.corner(t, (k + 1) % 3) - start;
    const Real reach = from.surface.has(MeshMark::valley, t, k) ? hollow : slack;
    if (dot(cross(n, edge), p - start) < -reach * length(edge)) return false;
  }
  return true;
}

/// The same for a point that may lie a few envelopes, or as deep as in this face, in the other wall of a hollow.
GONOGO_HD inline bool may_be_on(const MeshFrom& from, Index t, const Vec3& n, const Vec3& p, Real gap,
                                const Tolerance& tol) {
  if (gap >= tol.envelope || gap < -tol.limit) return false;
  return is_over(from, t, n, p, tol.slack, 4 * std::fmax(tol.envelope, -gap));
}

GONOGO_HD inline Vec3 centroid(const MeshFrom& from, Index t) {
  return (from.corner(t, 0) + from.corner(t, 1) + from.corner(t, 2)) * Real(1.0 / 3);
}

/// Distance [m] by which a point of a leaning body may lie outside of a face in which it is `-gap` deep.
GONOGO_HD inline Real off_surface(Real gap, Real slack) {
  return slack + std::fmin(-kLean * std::fmin(gap, Real(0)), 50 * slack);
}

/// A point that may have entered a mesh by `-gap` through a feature with the given middle: triangle `t`, or a ridge if
/// t is negative.
struct WayOut {
  Index t;
  Vec3 middle;
  Vec3 p;
  Real gap;
};

/// Whether another way out is preferred to one of length `gap`: it is shorter, and clearly shorter where the body only
/// leans on it.
template <class Supports>
GONOGO_HD inline bool goes_before(Real other, Real gap, Real slack, Supports&& supports) {
  if (other < gap + slack) return false;
  return supports(other > Real(0.7) * gap ? kLean : kStrict);
}

/// The triangle of a mesh that is nearest to a point, of those offered.
struct NearestTriangle {
  Index t = -1;
  OnTriangle on{};
  Real distance = Real(1e30);

  GONOGO_HD void offer(const MeshFrom& from, const Vec3& p, Index triangle) {
    const Vec3 a = from.corner(triangle, 0) - p, b = from.corner(triangle, 1) - p, c = from.corner(triangle, 2) - p;
    const OnTriangle here = nearest_on_triangle(a, b, c);
    const Real apart = length(here.point);
    if (!(apart < distance)) return;
    distance = apart;
    t = triangle;
    on = here;
  }
};

/// Whether the point leaves the solid there: it is inside, no other face beside a convex edge is a shorter way out, and
/// this is the first triangle of a flat face. supports(n, lean): whether the other body's point may press along n.
template <class Supports>
GONOGO_HD inline bool leads_out(const MeshFrom& from, const WayOut& way, const Tolerance& tol, Supports&& supports) {
  const bool deep = way.gap < -tol.slack;
  const Real reach = (deep ? -way.gap : Real(0)) + 2 * tol.slack;
  const Real beside = off_surface(way.gap, tol.slack);
  // A ridge lies in both of its faces, so they are no other way out.
  const Real below = way.t >= 0 ? Real(0) : -tol.slack;
  const Real wide = 10 * tol.slack;  // at acute corners a point is further from a triangle than from its edges
  const Vec3 box{reach, reach, reach};
  // Above a flat face the foot selects the triangle: the point itself may be an envelope away from all of them.
  const Vec3 at = way.t >= 0 && !deep ? way.p - from.normal(way.t) * way.gap : way.p;
  bool out = true;
  NearestTriangle nearest;
  from.surface.visit_near(at - box, at + box, [&](Index t) {
    if (!out) return;
    if (deep) nearest.offer(from, way.p, t);
    if (t == way.t) return;
    const bool same_face = way.t >= 0 && from.surface.name(t) == from.surface.name(way.t);
    if (same_face ? t > way.t : !deep) return;
    const Vec3 n = from.normal(t), base = from.corner(t, 0);
    if (same_face) {
      out = !is_over(from, t, n, way.p, tol.slack, tol.slack);
      return;
    }
    const Real gap = dot(way.p - base, n);
    if (gap > beside || dot(way.middle - base, n) >= below) return;
    if (goes_before(gap, way.gap, tol.slack, [&](Real lean) { return supports(-n, lean); }))
      out = !is_over(from, t, n, way.p, wide, wide);
  });
  if (!out || !deep) return out;
  return nearest.t >= 0 &&
         (nearest.distance < beside || dot(nearest.on.point, from.outward(nearest.t, nearest.on.feature)) > 0);
}

/// Whether a ridge of a mesh, whose point `p` is `-gap` deep in a box or cylinder, would leave it sooner through one of
/// its sides.
GONOGO_HD inline bool leaves_sooner(const Convex& solid, const Edge& ridge, const Vec3& p, Real gap, Real slack) {
  const Sides sides = sides_at(solid, p);
  bool sooner = false;
  for (int k = 0; k < sides.count; ++k) {
    if (sides.gap[k] > off_surface(gap, slack)) return false;
    const auto supports = [&](Real lean) { return ridge.supports(-sides.normal[k], lean); };
    sooner = sooner || goes_before(sides.gap[k], gap, slack, supports);
  }
  return sooner;
}

/// Where two edges cross, seen along the normal, which leads from b to a.
struct Crossing {
  Vec3 normal, on_a, on_b;
  Real gap;
};

/// Where the lines of two edges cross; false if they are parallel within 2 degrees. `s`, `t`: along a and b, 0 .. 1
/// between the ends.
GONOGO_HD inline bool lines_cross(const Edge& a, const Edge& b, Crossing& c, Real& s, Real& t) {
  const Vec3 square = cross(a.along, b.along);
  const Real size = length(square);
  if (size < Real(0.03) * length(a.along) * length(b.along)) return false;
  c.normal = square * ((dot(square, b.inward + b.beyond) > 0 ? Real(-1) : Real(1)) / size);
  const Vec3 w = b.start - a.start;
  const Real area = dot(square, c.normal);
  s = dot(cross(w, b.along), c.normal) / area;
  t = dot(cross(w, a.along), c.normal) / area;
  c.on_a = a.start + a.along * s;
  c.on_b = b.start + b.along * t;
  c.gap = dot(c.normal, c.on_a - c.on_b);
  return true;
}

/// Whether two crossing edges face each other and are near enough to touch.
GONOGO_HD inline bool may_touch(const Edge& a, const Edge& b, const Crossing& c, const Tolerance& tol) {
  return c.gap < tol.envelope && c.gap > -tol.limit && b.is_outer(c.normal, kLean) && a.is_outer(-c.normal, kLean);
}

GONOGO_HD inline bool is_between_ends(const Edge& e, Real at, Real slack) {
  const Real end = slack / length(e.along);
  return at >= -end && at <= 1 + end;
}

GONOGO_HD inline bool edges_cross(const Edge& a, const Edge& b, const Tolerance& tol, Crossing& c) {
  Real s = 0, t = 0;
  return lines_cross(a, b, c, s, t) && is_between_ends(a, s, tol.slack) && is_between_ends(b, t, tol.slack) &&
         may_touch(a, b, c, tol);
}

}  // namespace gonogo::sim
