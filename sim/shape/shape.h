// Shapes that touch. A shape belongs to a body; a body may carry several (a compound).
#pragma once
#include "base/view.h"

namespace gonogo::sim {

using BodyIndex = Index;
using ShapeIndex = Index;
using WorldIndex = Index;

/// none: an empty place in a batch; it touches nothing.
enum class ShapeType : std::int32_t { sphere, box, plane, wheel, none };

/// Number of materials a world can tell apart.
inline constexpr int kMaxMaterials = 4;

struct Shape {
  ShapeType type = ShapeType::sphere;
  BodyIndex body = 0;
  std::int32_t material = 0;  // < kMaxMaterials
  std::int32_t lug_count = 0;
  Vec3 offset_B;  // of the shape's centre from the body's centre of mass [m]
  /// sphere: (radius, -, -). box: half edges. plane: through the centre, its normal is the body's z axis.
  /// wheel: (radius without lugs, half width, lug height); its axle is the body's y axis. [m]
  Vec3 size;
  Real lug_thickness = 0;  // along the circumference [m]
};

/// Distance of the outer edges of a wheel's lugs from the axle: a little more than radius plus lug height [m].
GONOGO_HD inline Real lug_edge_radius(const Shape& wheel) {
  const Real tip = wheel.size.x + wheel.size.z, half = Real(0.5) * wheel.lug_thickness;
  return std::sqrt(tip * tip + half * half);
}

}  // namespace gonogo::sim
