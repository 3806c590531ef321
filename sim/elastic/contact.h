// Contact between surfaces of elastic bodies and rigid shapes: gaps, projections, tractions,
// forces and their consistent tangent. Internal: Eigen.
#pragma once
#include <Eigen/Sparse>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "sim/elastic/model.h"

namespace gonogo::sim::elastic {

// Numbers with their derivatives by N variables: forward differentiation, exact to round-off.
// Contact forces are written once on Dual; their consistent tangent follows without a second formula.

template <int N>
struct Dual {
  double value = 0;
  std::array<double, N> slope{};  // derivative by each variable

  Dual() = default;
  Dual(double v) : value(v) {}  // a constant; implicit, as in every formula

  static Dual variable(double v, int index) {
    Dual x(v);
    x.slope[std::size_t(index)] = 1;
    return x;
  }
  Dual& operator+=(const Dual& o) {
    value += o.value;
    for (int i = 0; i < N; ++i) slope[i] += o.slope[i];
    return *this;
  }
  Dual& operator-=(const Dual& o) {
    value -= o.value;
    for (int i = 0; i < N; ++i) slope[i] -= o.slope[i];
    return *this;
  }
  Dual& operator*=(const Dual& o) {
    for (int i = 0; i < N; ++i) slope[i] = slope[i] * o.value + value * o.slope[i];
    value *= o.value;
    return *this;
  }
  Dual& operator/=(const Dual& o) {
    value /= o.value;
    for (int i = 0; i < N; ++i) slope[i] = (slope[i] - value * o.slope[i]) / o.value;
    return *this;
  }
  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  friend Dual operator-(Dual a) { return a *= Dual(-1); }
};

inline double value_of(double x) { return x; }
template <int N>
double value_of(const Dual<N>& x) {
  return x.value;
}

inline double root(double x) { return std::sqrt(x); }
/// Only above 0.
template <int N>
Dual<N> root(Dual<N> x) {
  x.value = std::sqrt(x.value);
  for (double& s : x.slope) s /= 2 * x.value;
  return x;
}

/// Angle of the direction (x, y) from the x axis, in (-pi, pi]. Not at the origin.
inline double angle(double y, double x) { return std::atan2(y, x); }
template <int N>
Dual<N> angle(const Dual<N>& y, const Dual<N>& x) {
  Dual<N> a(std::atan2(y.value, x.value));
  const double square = x.value * x.value + y.value * y.value;
  for (int i = 0; i < N; ++i) a.slope[i] = (x.value * y.slope[i] - y.value * x.slope[i]) / square;
  return a;
}

inline double power(double x, double exponent) { return std::pow(x, exponent); }
/// Only above 0.
template <int N>
Dual<N> power(Dual<N> x, double exponent) {
  const double slope = exponent * std::pow(x.value, exponent - 1);
  x.value = std::pow(x.value, exponent);
  for (double& s : x.slope) s *= slope;
  return x;
}

// Gap and normal of a point above a rigid shape, for plain numbers and for Dual.

template <class T>
Vec3T<T> constant(const Vec3d& v) {
  return {T(v.x), T(v.y), T(v.z)};
}
template <class T>
Vec3d value_of(const Vec3T<T>& v) {
  return {value_of(v.x), value_of(v.y), value_of(v.z)};
}

template <class T>
struct Gap {
  T gap{};            // [m], below 0: overlap
  Vec3T<T> normal{};  // unit, out of the obstacle
};

/// `shape` displaced by `by`. The centre of a ball and the axis of a cylinder have no normal: the x axis stands in.
template <class T>
Gap<T> gap_above(const RigidShape& shape, const Vec3d& by, const Vec3T<T>& x) {
  Vec3T<T> d = x - constant<T>(shape.point + by);
  const Vec3T<T> axis = constant<T>(shape.axis);
  if (shape.kind == RigidKind::half_space) return {dot(d, axis), axis};
  if (shape.kind == RigidKind::cylinder) d -= axis * dot(d, axis);
  const T square = dot(d, d);
  if (!(value_of(square) > 0)) return {T(-shape.radius), constant<T>({1, 0, 0})};
  const T distance = root(square);
  return {distance - T(shape.radius), d * (T(1) / distance)};
}

// Closest point of a face of another body, for plain numbers and for Dual. The projection of a Dual is found on its
// value; one more Newton step in Dual arithmetic gives its derivative, by the theorem of implicit functions.

template <class T>
struct Projection {
  Gap<T> gap;
  std::array<T, 4> weight{};  // of the face's corners at the closest point
  double distance = 0;        // to the closest point [m]
};

/// Projection onto an edge from corner[0] to corner[1], body on the left. Beyond an end the closest point is the end
/// itself, which counts only where the surface goes on there, by `goes_on`.
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

/// Projection onto a 3-D face. None beyond its edges: the neighbour's face counts there.
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

// Traction on a contact point by ContactLaw, with its slopes by the displacements.

/// Friction per c_t w^m_t: psi'(|v|) v / |v|, also at rest.
template <class T>
Vec3T<T> friction_direction(const Vec3T<T>& v, double epsilon) {
  const T square = dot(v, v);
  if (!(value_of(square) > 1e-24 * epsilon * epsilon)) return v * T(2 / epsilon);
  const T speed = root(square);
  if (value_of(speed) < epsilon) return v * ((T(2) - speed / T(epsilon)) / T(epsilon));
  return v * (T(1) / speed);
}

template <int N>
struct Traction3 {
  Dual<N> pressure{};
  Vec3T<Dual<N>> shear{}, sliding{};
};

/// Pressure and friction of an overlap by ContactLaw.
template <int N>
Traction3<N> traction_of(const ContactLaw& law, const Gap<Dual<N>>& gap, const Vec3T<Dual<N>>& velocity) {
  Traction3<N> t;
  const Dual<N> w = -gap.gap;
  t.pressure = Dual<N>(law.c_n) * power(w, law.m_n);
  t.sliding = velocity - gap.normal * dot(velocity, gap.normal);
  if (law.c_t > 0) t.shear = friction_direction(t.sliding, law.epsilon) * (Dual<N>(-law.c_t) * power(w, law.m_t));
  return t;
}

using Vector = Eigen::VectorXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Where and how fast everything is. Friction acts on v; v changes by `rate` [1/s] times the change of u.
struct Motion {
  const Vector& u;  // [dof]
  const Vector& v;  // [dof]
  double rate = 0;
  double time = 0, step = 0;  // rigid shapes move from time - step to time
};

class ContactForces {
 public:
  /// `first` degree of freedom of each body. Keeps a reference to the model.
  ContactForces(const Model& model, std::vector<int> first);

  /// Adds the forces on the bodies [N], and to `tangent` minus their derivative by u. `points`, if given, becomes the
  /// state of every Gauss point. Returns the energy stored in the normal compliance [J].
  double add(const Motion& motion, Vector& force, Triplets* tangent, std::vector<ContactPoint>* points) const;
  bool has_friction() const;
  bool empty() const { return place_.empty(); }

 private:
  struct Place {  // a Gauss point
    int contact = 0;
    std::size_t face = 0;
    std::array<double, 4> n{};
    double area = 0;
  };
  struct Side {  // a face of the other body, displaced
    std::array<Vec3d, 4> corner{};
    Vec3d centre{};
    double radius = 0;
  };
  using Sides = std::vector<std::vector<Side>>;  // [contact][other_face]

  void prepare(int contact);
  Sides sides_of(const Vector& u) const;
  int nearest_face(const Place& p, const Vec3d& x, const std::vector<Side>& sides) const;
  double at_place(const Place& p, const Motion& motion, const Sides& sides, Vector& force, Triplets* tangent,
                  ContactPoint& state) const;
  template <int N>
  double with_slopes(const Place& p, int other_face, const Motion& motion, Vector& force, Triplets* tangent,
                     ContactPoint& state) const;

  const Model& model_;
  std::vector<int> first_;
  int dimension_;
  std::vector<Place> place_;
  std::vector<std::vector<std::array<bool, 2>>> goes_on_;  // [contact][other_face]: ends of edges shared with others
  std::vector<double> reach_;                              // [contact]
};

}  // namespace gonogo::sim::elastic
