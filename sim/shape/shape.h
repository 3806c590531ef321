// Shapes of bodies, which touch each other. A body may have several (a compound).
#pragma once
#include "base/parallel/buffer.h"

namespace gonogo::sim {

using BodyIndex = Index;
using ShapeIndex = Index;
using WorldIndex = Index;

/// The first shape of a pair is the one whose type comes first here. none: an empty place in a batch, which touches
/// nothing.
enum class ShapeType : std::int32_t {
  sphere,
  capsule,
  ellipsoid,
  cylinder,
  box,
  wheel,
  mesh,
  plane,
  heightfield,
  none
};
inline constexpr int kShapeTypes = 9;

/// Max materials of a world.
inline constexpr int kMaxMaterials = 4;

struct Shape {
  ShapeType type = ShapeType::sphere;
  BodyIndex body = 0;
  std::int32_t material = 0;  // < kMaxMaterials
  std::int32_t group = 0;     // shapes of one group other than 0 never touch, such as parts of a vehicle
  std::int32_t lug_count = 0;
  std::int32_t surface =
      -1;         // mesh, heightfield: index in the world's list of them; set by flatten to the batch's list
  Vec3 offset_B;  // of the shape's centre from the body's centre of mass [m]
  /// sphere: (radius, -, -). ellipsoid: half axes. box: half edges. plane: through the centre, its normal is the z
  /// axis. capsule, cylinder: (radius, half length without caps, -). wheel: (radius without lugs, half width, lug
  /// height). Capsules, cylinders and wheels turn about their y axis. mesh, heightfield: set by flatten. [m]
  Vec3 size;
  Real lug_thickness = 0;  // along the circumference [m]
  Quat turn_B;             // from the shape's axes to the body's
};

/// Whether all numbers of a vector are finite; host only.
template <class V>
bool is_finite(const V& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// For assertions. NaN passes: a world that has raised flag_not_finite goes on.
GONOGO_HD inline bool is_unit(const Vec3& v) { return !(std::fabs(dot(v, v) - 1) > Real(1e-3)); }
GONOGO_HD inline bool is_unit(const Vec3d& v) { return !(std::fabs(dot(v, v) - 1) > 1e-3); }
GONOGO_HD inline bool is_unit(const Quat& q) {
  return !(std::fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) > Real(1e-2));
}
GONOGO_HD inline bool is_material(std::int32_t m) { return m >= 0 && m < kMaxMaterials; }

/// Axes of a shape in the world.
GONOGO_HD inline Quat shape_orientation(const Shape& s, const Quat& body) {
  return s.turn_B.w == 1 ? body : body * s.turn_B;
}

/// Distance of the outer edges of a wheel's lugs from the axle: a little more than radius plus lug height [m].
GONOGO_HD inline Real lug_edge_radius(const Shape& wheel) {
  const Real tip = wheel.size.x + wheel.size.z, half = Real(0.5) * wheel.lug_thickness;
  return std::sqrt(tip * tip + half * half);
}

/// Radius of the bounding sphere about the shape's centre [m]; 0 for planes.
GONOGO_HD inline Real bounding_radius(const Shape& s) {
  switch (s.type) {
    case ShapeType::sphere:
    case ShapeType::mesh:
    case ShapeType::heightfield:
      return s.size.x;
    case ShapeType::capsule:
      return s.size.x + s.size.y;
    case ShapeType::ellipsoid:
      return std::fmax(s.size.x, std::fmax(s.size.y, s.size.z));
    case ShapeType::cylinder:
      return std::sqrt(s.size.x * s.size.x + s.size.y * s.size.y);
    case ShapeType::box:
      return length(s.size);
    case ShapeType::wheel: {
      const Real edge = lug_edge_radius(s);
      return std::sqrt(edge * edge + s.size.y * s.size.y);
    }
    case ShapeType::plane:
    case ShapeType::none:
      return 0;
  }
  return 0;
}

/// Radius of a sphere or capsule; 0 for other shapes [m].
GONOGO_HD inline Real round_radius(const Shape& s) {
  return s.type == ShapeType::sphere || s.type == ShapeType::capsule ? s.size.x : Real(0);
}

/// Radius of a shape without corners in the contact laws, of an ellipsoid the mean of its half axes; 0 for others [m].
GONOGO_HD inline Real mean_radius(const Shape& s) {
  return s.type == ShapeType::ellipsoid ? (s.size.x + s.size.y + s.size.z) / 3 : round_radius(s);
}

/// Radius in the law of rolling resistance [m]. Two round shapes: r1 r2 / (r1 + r2). One: its radius. None: that of a
/// cylinder or wheel, or 0 for boxes and meshes.
GONOGO_HD inline Real rolling_radius(const Shape& a, const Shape& b) {
  const Real ra = mean_radius(a), rb = mean_radius(b);
  if (ra > 0 && rb > 0) return ra * rb / (ra + rb);
  if (ra > 0 || rb > 0) return std::fmax(ra, rb);
  const auto rolls = [](const Shape& s) { return s.type == ShapeType::cylinder || s.type == ShapeType::wheel; };
  return rolls(a) ? a.size.x : rolls(b) ? b.size.x : Real(0);
}

/// Radius of the circle on which cohesion acts: the smaller round one; 0 for pairs without one [m].
GONOGO_HD inline Real cohesion_radius(const Shape& a, const Shape& b) {
  const Real ra = mean_radius(a), rb = mean_radius(b);
  return ra > 0 && rb > 0 ? std::fmin(ra, rb) : std::fmax(ra, rb);
}

/// Half of the smallest extent of a shape [m]; 0 for planes and heightfields. Limits of overlaps refer to it.
GONOGO_HD inline Real smallest_half(const Shape& s) {
  switch (s.type) {
    case ShapeType::box:
    case ShapeType::ellipsoid:
      return std::fmin(s.size.x, std::fmin(s.size.y, s.size.z));
    case ShapeType::cylinder:
    case ShapeType::wheel:
      return std::fmin(s.size.x, s.size.y);
    case ShapeType::mesh:
      return s.size.y;
    case ShapeType::plane:
    case ShapeType::heightfield:
      return 0;
    default:
      return s.size.x;
  }
}

}  // namespace gonogo::sim
