#include "sim/elastic/element_matrices.h"

#include <numbers>

namespace gonogo::sim::elastic {

Matrix6 elasticity(const Material& m, bool plane_stress) {
  const double shear = m.young / (2 * (1 + m.poisson));
  Matrix6 d = Matrix6::Zero();
  if (plane_stress) {
    const double c = m.young / (1 - m.poisson * m.poisson);
    d(0, 0) = d(1, 1) = c;
    d(0, 1) = d(1, 0) = c * m.poisson;
    d(3, 3) = shear;
    return d;
  }
  const double lambda = m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson));
  d.topLeftCorner<3, 3>().setConstant(lambda);
  for (int i = 0; i < 3; ++i) {
    d(i, i) += 2 * shear;
    d(i + 3, i + 3) = shear;
  }
  return d;
}

StrainMatrix strain_matrix(int corners, int dimension, const Gradient& g, const ShapeValues& s, double radius) {
  StrainMatrix b = StrainMatrix::Zero(6, corners * dimension);
  for (int k = 0; k < corners; ++k) {
    const Vec3d& slope = g.slope[std::size_t(k)];
    const int at = k * dimension;
    b(0, at) = b(3, at + 1) = slope.x;
    b(1, at + 1) = b(3, at) = slope.y;
    if (dimension == 3) {
      b(2, at + 2) = b(4, at + 1) = b(5, at) = slope.z;
      b(4, at + 2) = slope.y;
      b(5, at + 2) = slope.x;
    } else if (radius > 0) {
      b(2, at) = s.n[std::size_t(k)] / radius;
    }
  }
  return b;
}

PointVolume volume_at(const Body& body, std::size_t element, const QuadraturePoint& q, const ShapeValues& s,
                      const Gradient& g) {
  PointVolume v;
  v.volume = q.weight * g.determinant;
  if (dimension_of(body.mesh.kind) == 3) return v;
  if (body.plane != Plane::axisymmetric) {
    v.volume *= body.thickness;
    return v;
  }
  for (int k = 0; k < corner_count(body.mesh.kind); ++k)
    v.radius += s.n[std::size_t(k)] * body.mesh.node[std::size_t(body.mesh.element[element][std::size_t(k)])].x;
  v.volume *= 2 * std::numbers::pi * v.radius;
  return v;
}

ElementMatrix stiffness_of(const Body& body, std::size_t element) {
  const int dimension = dimension_of(body.mesh.kind), corners = corner_count(body.mesh.kind);
  const Matrix6 d = elasticity(body.material, dimension == 2 && body.plane == Plane::stress);
  ElementMatrix k = ElementMatrix::Zero(corners * dimension, corners * dimension);
  for (const QuadraturePoint& q : quadrature_of(body.mesh.kind)) {
    const ShapeValues s = shape_values(body.mesh.kind, q.at);
    const Gradient g = gradient_of(body.mesh, element, s);
    const PointVolume v = volume_at(body, element, q, s, g);
    const StrainMatrix b = strain_matrix(corners, dimension, g, s, v.radius);
    k += b.transpose() * d * b * v.volume;
  }
  return k;
}

ElementMatrix consistent_mass_of(const Body& body, std::size_t element) {
  const int dimension = dimension_of(body.mesh.kind), corners = corner_count(body.mesh.kind);
  ElementMatrix m = ElementMatrix::Zero(corners * dimension, corners * dimension);
  for (const QuadraturePoint& q : quadrature_of(body.mesh.kind)) {
    const ShapeValues s = shape_values(body.mesh.kind, q.at);
    const double mass =
        body.material.density * volume_at(body, element, q, s, gradient_of(body.mesh, element, s)).volume;
    for (int a = 0; a < corners; ++a)
      for (int b = 0; b < corners; ++b)
        for (int c = 0; c < dimension; ++c)
          m(a * dimension + c, b * dimension + c) += mass * s.n[std::size_t(a)] * s.n[std::size_t(b)];
  }
  return m;
}

Eigen::VectorXd lumped_mass_of(const Body& body, std::size_t element) {
  const int dimension = dimension_of(body.mesh.kind), corners = corner_count(body.mesh.kind);
  const Eigen::VectorXd sums = consistent_mass_of(body, element).rowwise().sum();
  Eigen::VectorXd mass(corners);
  for (int k = 0; k < corners; ++k) mass[k] = sums[k * dimension];
  return mass;
}

}  // namespace gonogo::sim::elastic
