// Closest point of a face of another body, for plain numbers and for Dual. The projection of a Dual is found on its
// value; one more Newton step in Dual arithmetic gives its derivative, by the theorem of implicit functions.
#pragma once
#include <optional>

#include "sim/elastic/rigid_gap.h"

namespace gonogo::sim::elastic {

template <class T>
struct Projection {
  Gap<T> gap;
  std::array<T, 4> weight{};  // of the face's corners at the closest point
  double distance = 0;        // to the closest point [m]
};

/// Of an edge from corner[0] to corner[1], body on the left. Beyond an end the closest point is the end itself, which
/// counts only where the surface goes on there, by `goes_on`.
template <class T>
std::optional<Projection<T>> onto_edge(const Vec3T<T>& x, const std::array<Vec3T<T>, 4>& corner,
                                       const std::array<bool, 2>& goes_on) {
  const Vec3T<T> along = corner[1] - corner[0], d = x - corner[0];
  const T size = root(dot(along, along)), xi = dot(d, along) / (size * size);
  const Vec3T<T> normal{along.y / size, -along.x / size, T(0)};
  const T height = dot(d, normal);
  Projection<T> p;
  if (value_of(xi) >= 0 && value_of(xi) <= 1) {
    p.gap = {height, normal};
    p.weight = {T(1) - xi, xi, T(0), T(0)};
    p.distance = std::fabs(value_of(height));
    return p;
  }
  const std::size_t end = value_of(xi) < 0 ? 0 : 1;
  if (!goes_on[end]) return std::nullopt;
  const Vec3T<T> from = x - corner[end];
  const T square = dot(from, from);
  if (!(value_of(square) > 0)) return std::nullopt;
  const T distance = root(square), signed_distance = value_of(height) < 0 ? -distance : distance;
  p.gap = {signed_distance, from * (T(1) / signed_distance)};
  p.weight[end] = T(1);
  p.distance = value_of(distance);
  return p;
}

/// Place, tangents and twist of a triangle or bilinear quadrilateral at (xi, eta).
template <class T>
struct FacePlace {
  Vec3T<T> place{}, by_xi{}, by_eta{}, twist{};
  std::array<T, 4> weight{};
};

template <class T>
FacePlace<T> place_on(const std::array<Vec3T<T>, 4>& corner, int count, const T& xi, const T& eta) {
  FacePlace<T> p;
  std::array<T, 4> by_xi{}, by_eta{};
  std::array<double, 4> twist{};
  if (count == 3) {
    p.weight = {T(1) - xi - eta, xi, eta, T(0)};
    by_xi = {T(-1), T(1), T(0), T(0)};
    by_eta = {T(-1), T(0), T(1), T(0)};
  } else {
    static constexpr double a[4] = {-1, 1, 1, -1}, b[4] = {-1, -1, 1, 1};
    for (std::size_t k = 0; k < 4; ++k) {
      const T u = T(1) + T(a[k]) * xi, v = T(1) + T(b[k]) * eta;
      p.weight[k] = T(0.25) * u * v;
      by_xi[k] = T(a[k] / 4) * v;
      by_eta[k] = T(b[k] / 4) * u;
      twist[k] = a[k] * b[k] / 4;
    }
  }
  for (std::size_t k = 0; k < std::size_t(count); ++k) {
    p.place += corner[k] * p.weight[k];
    p.by_xi += corner[k] * by_xi[k];
    p.by_eta += corner[k] * by_eta[k];
    p.twist += corner[k] * T(twist[k]);
  }
  return p;
}

/// One Newton step towards the point where x - place is perpendicular to both tangents.
template <class T>
void step_to_foot(const Vec3T<T>& x, const std::array<Vec3T<T>, 4>& corner, int count, T& xi, T& eta) {
  const FacePlace<T> p = place_on(corner, count, xi, eta);
  const Vec3T<T> d = x - p.place;
  const T f1 = dot(d, p.by_xi), f2 = dot(d, p.by_eta);
  const T a = dot(p.by_xi, p.by_xi), b = dot(p.by_xi, p.by_eta) - dot(d, p.twist), c = dot(p.by_eta, p.by_eta);
  const T determinant = a * c - b * b;
  if (!(std::fabs(value_of(determinant)) > 0)) return;
  xi += (f1 * c - f2 * b) / determinant;
  eta += (f2 * a - f1 * b) / determinant;
}

inline bool on_face(int count, double xi, double eta) {
  constexpr double slack = 1e-6;
  return count == 3 ? xi >= -slack && eta >= -slack && xi + eta <= 1 + slack
                    : std::fabs(xi) <= 1 + slack && std::fabs(eta) <= 1 + slack;
}

/// Of a 3-D face. Nothing beyond its edges: the neighbour's face counts there.
template <class T>
std::optional<Projection<T>> onto_face(const Vec3T<T>& x, const std::array<Vec3T<T>, 4>& corner, int count) {
  std::array<Vec3d, 4> plain{};
  for (std::size_t k = 0; k < std::size_t(count); ++k) plain[k] = value_of(corner[k]);
  double xi0 = count == 3 ? 1.0 / 3 : 0, eta0 = xi0;
  for (int i = 0; i < (count == 3 ? 1 : 8); ++i) step_to_foot(value_of(x), plain, count, xi0, eta0);
  if (!on_face(count, xi0, eta0)) return std::nullopt;
  T xi(xi0), eta(eta0);
  step_to_foot(x, corner, count, xi, eta);
  const FacePlace<T> p = place_on(corner, count, xi, eta);
  const Vec3T<T> across = cross(p.by_xi, p.by_eta);
  Projection<T> found;
  found.gap.normal = across * (T(1) / root(dot(across, across)));
  found.gap.gap = dot(x - p.place, found.gap.normal);
  found.weight = p.weight;
  found.distance = std::fabs(value_of(found.gap.gap));
  return found;
}

template <class T>
std::optional<Projection<T>> project(const Vec3T<T>& x, const std::array<Vec3T<T>, 4>& corner, int count,
                                     const std::array<bool, 2>& goes_on) {
  return count == 2 ? onto_edge(x, corner, goes_on) : onto_face(x, corner, count);
}

}  // namespace gonogo::sim::elastic
