// Gap and normal of a sphere against each other shape. gap [m]: signed distance between the surfaces, negative when
// they overlap. normal: unit, from the other shape towards the sphere.
#pragma once
#include "sim/shape/shape.h"

namespace gonogo::sim {

struct Gap {
  Real gap;
  Vec3 normal;
};

/// `separation`: from the other sphere's centre to this one's.
GONOGO_HD inline Gap sphere_sphere_gap(const Vec3& separation, Real radius_sum) {
  GONOGO_ASSERT(radius_sum >= 0);
  const Real distance = length(separation);
  if (distance < Real(1e-12)) return {-radius_sum, {0, 0, 1}};
  return {distance - radius_sum, separation * (Real(1) / distance)};
}

/// `p`: the sphere's centre in the frame of the box. Inside, the normal leads out through the nearest face.
GONOGO_HD inline Gap sphere_box_gap(const Vec3& p, const Vec3& half, Real radius) {
  GONOGO_ASSERT(half.x > 0 && half.y > 0 && half.z > 0 && radius >= 0);
  const Vec3 q{std::fabs(p.x) - half.x, std::fabs(p.y) - half.y, std::fabs(p.z) - half.z};
  const Vec3 sign{p.x < 0 ? Real(-1) : Real(1), p.y < 0 ? Real(-1) : Real(1), p.z < 0 ? Real(-1) : Real(1)};
  const Vec3 out{std::fmax(q.x, Real(0)), std::fmax(q.y, Real(0)), std::fmax(q.z, Real(0))};
  const Real distance = length(out);
  if (distance > Real(1e-9)) return {distance - radius, scale(sign, out * (Real(1) / distance))};
  if (q.x >= q.y && q.x >= q.z) return {q.x - radius, {sign.x, 0, 0}};
  if (q.y >= q.z) return {q.y - radius, {0, sign.y, 0}};
  return {q.z - radius, {0, 0, sign.z}};
}

/// Segment from -half_length to half_length along y, thickened by `capsule_radius`; `p` in its frame.
GONOGO_HD inline Gap sphere_capsule_gap(const Vec3& p, Real capsule_radius, Real half_length, Real radius) {
  GONOGO_ASSERT(half_length >= 0 && capsule_radius > 0);
  const Real y = std::fmin(std::fmax(p.y, -half_length), half_length);
  return sphere_sphere_gap({p.x, p.y - y, p.z}, capsule_radius + radius);
}

/// Cylinder about y, or a wheel without its lugs; `p` in its frame.
GONOGO_HD inline Gap sphere_cylinder_gap(const Vec3& p, Real cylinder_radius, Real half_width, Real radius) {
  GONOGO_ASSERT(cylinder_radius > 0 && half_width > 0);
  const Real axial = std::fabs(p.y) - half_width;
  const Real from_axle = std::sqrt(p.x * p.x + p.z * p.z);
  const Real radial = from_axle - cylinder_radius;
  const Vec3 outward = from_axle > Real(1e-9) ? Vec3{p.x / from_axle, 0, p.z / from_axle} : Vec3{1, 0, 0};
  const Vec3 sideways{0, p.y < 0 ? Real(-1) : Real(1), 0};
  if (radial > 0 && axial > 0) {
    const Real distance = std::sqrt(radial * radial + axial * axial);
    return {distance - radius, outward * (radial / distance) + sideways * (axial / distance)};
  }
  return radial >= axial ? Gap{radial - radius, outward} : Gap{axial - radius, sideways};
}

/// Frame of lug `k` of a wheel, at angle 2 pi k / lug_count about the axle.
struct LugFrame {
  Real c, s;
  /// x outward along the lug's radius, z along the circumference, origin in the axle.
  GONOGO_HD Vec3 into(const Vec3& p) const { return {c * p.x + s * p.z, p.y, -s * p.x + c * p.z}; }
  GONOGO_HD Vec3 out_of(const Vec3& p) const { return {c * p.x - s * p.z, p.y, s * p.x + c * p.z}; }
};
GONOGO_HD inline LugFrame lug_frame(const Shape& wheel, int k) {
  GONOGO_ASSERT(k >= 0 && k < wheel.lug_count);
  const Real angle = Real(6.283185307179586) * Real(k) / Real(wheel.lug_count);
  return {std::cos(angle), std::sin(angle)};
}
GONOGO_HD inline Vec3 lug_half(const Shape& wheel) {
  return {wheel.size.z, wheel.size.y, Real(0.5) * wheel.lug_thickness};
}

/// A lug is a box on the rim, its foot sunk into the rim by its own height.
GONOGO_HD inline Gap sphere_lug_gap(const Vec3& p, const Shape& wheel, int k, Real radius) {
  const LugFrame frame = lug_frame(wheel, k);
  const Gap g = sphere_box_gap(frame.into(p) - Vec3{wheel.size.x, 0, 0}, lug_half(wheel), radius);
  return {g.gap, frame.out_of(g.normal)};
}

/// Calls visit(k) for the (at most) two lugs nearest to an angle about the axle [rad from x towards z].
template <class Visit>
GONOGO_HD inline void visit_nearest_lugs(const Shape& wheel, Real angle, Visit&& visit) {
  if (wheel.lug_count == 0) return;
  const Real turns = angle * (Real(wheel.lug_count) / Real(6.283185307179586));
  const int near = int(std::floor(turns + Real(0.5)));
  const int next = turns > Real(near) ? near + 1 : near - 1;
  for (const int lug : {near, next}) {
    if (wheel.lug_count == 1 && lug == next) return;
    visit(((lug % wheel.lug_count) + wheel.lug_count) % wheel.lug_count);
  }
}

/// Calls visit(feature, gap) for the cylinder (feature 0) and the two lugs nearest to `p` (features 1 + k).
template <class Visit>
GONOGO_HD inline void visit_wheel_gaps(const Vec3& p, const Shape& wheel, Real radius, Real envelope, Visit&& visit) {
  const Gap cylinder = sphere_cylinder_gap(p, wheel.size.x, wheel.size.y, radius);
  if (cylinder.gap > envelope + lug_edge_radius(wheel) - wheel.size.x) return;
  if (cylinder.gap < envelope) visit(0, cylinder);
  visit_nearest_lugs(wheel, std::atan2(p.z, p.x), [&](int k) {
    const Gap g = sphere_lug_gap(p, wheel, k, radius);
    if (g.gap < envelope) visit(1 + k, g);
  });
}

}  // namespace gonogo::sim
