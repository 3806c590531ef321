// Ellipsoids. With half axes e and A = diag(e), in their own axes: the reach along a unit direction n is |A n|, the
// furthest point A^2 n / |A n|. The outward normal at a point x of the surface is along A^-2 x.
#pragma once
#include "sim/shape/gap.h"

namespace gonogo::sim {

/// Furthest point along a direction of any length; own axes [m].
GONOGO_HD inline Vec3 ellipsoid_support(const Vec3& half, const Vec3& direction) {
  const Vec3 stretched = scale(half, direction);
  return scale(half, stretched) * (1 / length(stretched));
}

/// Outward unit normal at a point of the surface.
GONOGO_HD inline Vec3 ellipsoid_normal(const Vec3& half, const Vec3& x) {
  const Vec3 n{x.x / (half.x * half.x), x.y / (half.y * half.y), x.z / (half.z * half.z)};
  return n * (1 / length(n));
}

/// Point of the surface nearest to `p`, inside or outside: x_k = e_k^2 p_k / (s + e_k^2 - m^2), m the smallest half
/// axis, with s > 0 such that sum (x_k / e_k)^2 = 1 (Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a
/// Hyperellipsoid, 2013). The sum falls with s and is convex, so Newton's method from the left does not pass the root.
/// Lengths are in units of m. A point within a millionth of the plane of symmetry counts as in it; of two points that
/// are then equally near, one is returned.
GONOGO_HD_OUTLINED Vec3 nearest_on_ellipsoid(const Vec3& half, const Vec3& p) {
  const Real least = std::fmin(half.x, std::fmin(half.y, half.z));
  const Real e[3] = {half.x / least, half.y / least, half.z / least}, at[3] = {p.x / least, p.y / least, p.z / least};
  Real weight[3], shift[3], s = 0;
  for (int k = 0; k < 3; ++k) {
    weight[k] = e[k] * std::fmax(std::fabs(at[k]), Real(1e-6));
    shift[k] = (e[k] - 1) * (e[k] + 1);
    s = std::fmax(s, weight[k] - shift[k]);  // no term of the sum is above one there, and one of them is
  }
  for (int i = 0; i < 20; ++i) {
    Real excess = -1, slope = 0;
    for (int k = 0; k < 3; ++k) {
      const Real ratio = weight[k] / (s + shift[k]), square = ratio * ratio;
      excess += square;
      slope += square / (s + shift[k]);
    }
    const Real step = excess / (2 * slope);
    s += std::fmax(step, Real(0));
    if (!(step > Real(1e-7) * s)) break;
  }
  Real x[3], sum = 0;
  for (int k = 0; k < 3; ++k) {
    x[k] = weight[k] / (s + shift[k]);  // of the half axis
    sum += x[k] * x[k];
    if (at[k] < 0) x[k] = -x[k];
  }
  const Real onto = 1 / std::sqrt(sum);
  return {half.x * x[0] * onto, half.y * x[1] * onto, half.z * x[2] * onto};
}

/// A sphere against an ellipsoid. `p`: the sphere's centre in the ellipsoid's axes. Inside, the normal leads out
/// through the nearest point.
GONOGO_HD inline Gap sphere_ellipsoid_gap(const Vec3& p, const Vec3& half, Real radius) {
  const Vec3 x = nearest_on_ellipsoid(half, p), n = ellipsoid_normal(half, x);
  return {dot(p - x, n) - radius, n};
}

}  // namespace gonogo::sim
