// Small vectors for kernels. Velocities, impulses and all that a solver computes with are Real (float). Positions are
// double: metres from the origin, a gap of a thousandth of a grain must not be lost.
#pragma once
#include <cmath>
#include <cstdint>

#include "base/host_device.h"

namespace gonogo {

using Real = float;
using Index = std::int32_t;

template <class T>
struct Vec3T {
  T x{}, y{}, z{};

  GONOGO_HD Vec3T& operator+=(const Vec3T& o) {
    x += o.x;
    y += o.y;
    z += o.z;
    return *this;
  }
  GONOGO_HD Vec3T& operator-=(const Vec3T& o) {
    x -= o.x;
    y -= o.y;
    z -= o.z;
    return *this;
  }
  GONOGO_HD Vec3T& operator*=(T s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
  template <class U>
  GONOGO_HD explicit operator Vec3T<U>() const {
    return {U(x), U(y), U(z)};
  }
};

using Vec3 = Vec3T<Real>;
using Vec3d = Vec3T<double>;

template <class T>
GONOGO_HD inline Vec3T<T> operator+(Vec3T<T> a, const Vec3T<T>& b) {
  return a += b;
}
template <class T>
GONOGO_HD inline Vec3T<T> operator-(Vec3T<T> a, const Vec3T<T>& b) {
  return a -= b;
}
template <class T>
GONOGO_HD inline Vec3T<T> operator-(const Vec3T<T>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
GONOGO_HD inline Vec3T<T> operator*(Vec3T<T> a, T s) {
  return a *= s;
}
template <class T>
GONOGO_HD inline Vec3T<T> operator*(T s, Vec3T<T> a) {
  return a *= s;
}
/// a b + c. The GPU rounds once (fma), which is faster there.
template <class T>
GONOGO_HD inline T multiply_add(const T& a, const T& b, const T& c) {
#ifdef __CUDA_ARCH__
  return fma(a, b, c);
#else
  return a * b + c;
#endif
}
/// a s + c.
template <class T>
GONOGO_HD inline Vec3T<T> multiply_add(const Vec3T<T>& a, const T& s, const Vec3T<T>& c) {
  return {multiply_add(a.x, s, c.x), multiply_add(a.y, s, c.y), multiply_add(a.z, s, c.z)};
}
/// Component by component.
template <class T>
GONOGO_HD inline Vec3T<T> scale(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class T>
GONOGO_HD inline T dot(const Vec3T<T>& a, const Vec3T<T>& b) {
  return multiply_add(a.z, b.z, multiply_add(a.y, b.y, a.x * b.x));
}
template <class T>
GONOGO_HD inline Vec3T<T> cross(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// a x b + c.
template <class T>
GONOGO_HD inline Vec3T<T> cross_add(const Vec3T<T>& a, const Vec3T<T>& b, const Vec3T<T>& c) {
  return {multiply_add(a.y, b.z, multiply_add(-a.z, b.y, c.x)), multiply_add(a.z, b.x, multiply_add(-a.x, b.z, c.y)),
          multiply_add(a.x, b.y, multiply_add(-a.y, b.x, c.z))};
}
template <class T>
GONOGO_HD inline T length(const Vec3T<T>& a) {
  return std::sqrt(dot(a, a));
}

/// Symmetric 3x3 matrix.
struct SymMat3 {
  Real xx{}, yy{}, zz{}, xy{}, xz{}, yz{};
  GONOGO_HD Vec3 operator*(const Vec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
};

/// Rotation from body to world, unit length.
struct Quat {
  Real w = 1, x = 0, y = 0, z = 0;
};

GONOGO_HD inline Vec3 rotate(const Quat& q, const Vec3& v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = Real(2) * cross(u, v);
  return v + q.w * t + cross(u, t);
}

/// R v for a quaternion whose length may be off by rounding.
GONOGO_HD inline Vec3d rotate_precisely(const Quat& q, const Vec3& v_B) {
  const Vec3d u{q.x, q.y, q.z}, v = static_cast<Vec3d>(v_B);
  const double w = q.w, scale = 2 / (w * w + dot(u, u));
  const Vec3d t = cross(u, v);
  return v + scale * (w * t + cross(u, t));
}

GONOGO_HD inline Vec3 rotate_back(const Quat& q, const Vec3& v) { return rotate({q.w, -q.x, -q.y, -q.z}, v); }

GONOGO_HD inline Quat conjugate(const Quat& q) { return {q.w, -q.x, -q.y, -q.z}; }

GONOGO_HD inline Quat operator*(const Quat& a, const Quat& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

GONOGO_HD inline Quat normalised(const Quat& q) {
  const Real s = Real(1) / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w * s, q.x * s, q.y * s, q.z * s};
}

/// Orientation after turning for `step` seconds at constant angular velocity [rad/s, world frame].
GONOGO_HD inline Quat turned(const Quat& q, const Vec3& angular_velocity_W, Real step) {
  const Real half = Real(0.5) * step;
  const Quat rate{0, angular_velocity_W.x * half, angular_velocity_W.y * half, angular_velocity_W.z * half};
  const Quat d = rate * q;
  return normalised({q.w + d.w, q.x + d.x, q.y + d.y, q.z + d.z});
}

/// R diag(d) R^T.
GONOGO_HD inline SymMat3 rotated_diagonal(const Quat& q, const Vec3& d) {
  const Vec3 ex = rotate(q, {1, 0, 0}), ey = rotate(q, {0, 1, 0}), ez = rotate(q, {0, 0, 1});
  return {d.x * ex.x * ex.x + d.y * ey.x * ey.x + d.z * ez.x * ez.x,
          d.x * ex.y * ex.y + d.y * ey.y * ey.y + d.z * ez.y * ez.y,
          d.x * ex.z * ex.z + d.y * ey.z * ey.z + d.z * ez.z * ez.z,
          d.x * ex.x * ex.y + d.y * ey.x * ey.y + d.z * ez.x * ez.y,
          d.x * ex.x * ex.z + d.y * ey.x * ey.z + d.z * ez.x * ez.z,
          d.x * ex.y * ex.z + d.y * ey.y * ey.z + d.z * ez.y * ez.z};
}

}  // namespace gonogo
