#include "sim/elastic/shape_functions.h"

#include <cmath>

namespace gonogo::sim::elastic {
namespace {

constexpr double kGauss2 = 0.57735026918962576;  // 1/sqrt(3)

ShapeValues simplex(int dimension, const std::array<double, 3>& at) {
  ShapeValues s;
  s.n[0] = 1;
  for (int d = 0; d < dimension; ++d) {
    s.n[0] -= at[std::size_t(d)];
    s.n[std::size_t(d) + 1] = at[std::size_t(d)];
    s.slope[0][std::size_t(d)] = -1;
    s.slope[std::size_t(d) + 1][std::size_t(d)] = 1;
  }
  return s;
}

/// Products of (1 + sign x) / 2 along each direction.
ShapeValues cube(int dimension, const std::array<double, 3>& at) {
  static constexpr double sign[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                        {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  ShapeValues s;
  for (std::size_t k = 0; k < (dimension == 2 ? 4u : 8u); ++k) {
    double factor[3] = {1, 1, 1};
    for (int d = 0; d < dimension; ++d) factor[d] = (1 + sign[k][d] * at[std::size_t(d)]) / 2;
    s.n[k] = factor[0] * factor[1] * factor[2];
    for (int d = 0; d < dimension; ++d)
      s.slope[k][std::size_t(d)] = sign[k][d] / 2 * factor[(d + 1) % 3] * factor[(d + 2) % 3];
  }
  return s;
}

std::vector<QuadraturePoint> cube_points(int dimension) {
  std::vector<QuadraturePoint> points;
  for (int k = 0; k < (dimension == 2 ? 4 : 8); ++k) {
    QuadraturePoint q;
    q.weight = 1;
    for (int d = 0; d < dimension; ++d) q.at[std::size_t(d)] = (k >> d & 1) ? kGauss2 : -kGauss2;
    points.push_back(q);
  }
  return points;
}

/// Degree 2: points on the lines from the centre to the corners; Hughes, tables 3.I.1 and 3.I.2.
std::vector<QuadraturePoint> simplex_points(int dimension) {
  const double far = dimension == 2 ? 2.0 / 3 : 0.5854101966249685,
               near = dimension == 2 ? 1.0 / 6 : 0.1381966011250105;
  std::vector<QuadraturePoint> points;
  for (int k = 0; k <= dimension; ++k) {
    QuadraturePoint q;
    q.weight = dimension == 2 ? 1.0 / 6 : 1.0 / 24;
    for (int d = 0; d < dimension; ++d) q.at[std::size_t(d)] = d + 1 == k ? far : near;
    points.push_back(q);
  }
  return points;
}

struct LinePoint {
  double at, weight;
};

/// Gauss-Legendre on [-1, 1], weights adding up to 2.
std::vector<LinePoint> gauss(int points) {
  switch (points) {
    case 1:
      return {{0, 2}};
    case 2:
      return {{-kGauss2, 1}, {kGauss2, 1}};
    case 3:
      return {{-0.774596669241483377, 5.0 / 9}, {0, 8.0 / 9}, {0.774596669241483377, 5.0 / 9}};
    case 4:
      return {{-0.861136311594052575, 0.347854845137453857},
              {-0.339981043584856265, 0.652145154862546143},
              {0.339981043584856265, 0.652145154862546143},
              {0.861136311594052575, 0.347854845137453857}};
    default:
      return {{-0.906179845938663993, 0.236926885056189088},
              {-0.538469310105683091, 0.478628670499366468},
              {0, 128.0 / 225},
              {0.538469310105683091, 0.478628670499366468},
              {0.906179845938663993, 0.236926885056189088}};
  }
}

/// On the unit triangle, weights adding up to 1/2: degree 1, 2, or 4 (Dunavant 1985).
std::vector<QuadraturePoint> triangle_points(int points) {
  if (points == 1) return {{{1.0 / 3, 1.0 / 3, 0}, 0.5}};
  if (points <= 3) return simplex_points(2);
  std::vector<QuadraturePoint> six;
  const double a[2] = {0.445948490915965, 0.091576213509771}, w[2] = {0.223381589678011 / 2, 0.109951743655322 / 2};
  for (int k = 0; k < 2; ++k) {
    six.push_back({{a[k], a[k], 0}, w[k]});
    six.push_back({{1 - 2 * a[k], a[k], 0}, w[k]});
    six.push_back({{a[k], 1 - 2 * a[k], 0}, w[k]});
  }
  return six;
}

}  // namespace

ShapeValues shape_values(ElementKind kind, const std::array<double, 3>& at) {
  const bool is_simplex = kind == ElementKind::t3 || kind == ElementKind::t4;
  return is_simplex ? simplex(dimension_of(kind), at) : cube(dimension_of(kind), at);
}

const std::vector<QuadraturePoint>& quadrature_of(ElementKind kind) {
  static const std::vector<QuadraturePoint> t3 = simplex_points(2), q4 = cube_points(2), t4 = simplex_points(3),
                                            h8 = cube_points(3);
  return kind == ElementKind::t3 ? t3 : kind == ElementKind::q4 ? q4 : kind == ElementKind::t4 ? t4 : h8;
}

FacePoint face_values(int corners, double xi, double eta) {
  FacePoint p;
  if (corners == 2) {  // xi in [0, 1] from the first corner to the second
    p.n = {1 - xi, xi, 0, 0};
    p.slope[0][0] = -1;
    p.slope[1][0] = 1;
    return p;
  }
  const ShapeValues s = shape_values(corners == 3 ? ElementKind::t3 : ElementKind::q4, {xi, eta, 0});
  for (std::size_t k = 0; k < std::size_t(corners); ++k) {
    p.n[k] = s.n[k];
    p.slope[k] = {s.slope[k][0], s.slope[k][1]};
  }
  return p;
}

std::vector<FacePoint> face_quadrature(int corners, int points) {
  std::vector<FacePoint> all;
  const auto add = [&](double xi, double eta, double weight) {
    all.push_back(face_values(corners, xi, eta));
    all.back().weight = weight;
  };
  if (corners == 3) {
    for (const QuadraturePoint& q : triangle_points(points)) add(q.at[0], q.at[1], q.weight);
    return all;
  }
  for (const LinePoint& a : gauss(points)) {
    if (corners == 2) add((1 + a.at) / 2, 0, a.weight / 2);
    if (corners == 4)
      for (const LinePoint& b : gauss(points)) add(a.at, b.at, a.weight * b.weight);
  }
  return all;
}

double face_measure(int corners, const FacePoint& p, const std::array<Vec3d, 4>& x) {
  Vec3d along, across;
  for (std::size_t k = 0; k < std::size_t(corners); ++k) {
    along += x[k] * p.slope[k][0];
    across += x[k] * p.slope[k][1];
  }
  return corners == 2 ? length(along) : length(cross(along, across));
}

Gradient gradient_of(const Mesh& mesh, std::size_t element, const ShapeValues& s) {
  const int corners = corner_count(mesh.kind);
  Vec3d j[3];  // rows: derivative of the place by each local coordinate
  for (int k = 0; k < corners; ++k)
    for (int d = 0; d < 3; ++d)
      j[d] += mesh.node[std::size_t(mesh.element[element][std::size_t(k)])] * s.slope[std::size_t(k)][std::size_t(d)];
  if (dimension_of(mesh.kind) == 2) j[2] = {0, 0, 1};
  Gradient g;
  g.determinant = dot(j[0], cross(j[1], j[2]));
  const Vec3d inverse[3] = {cross(j[1], j[2]), cross(j[2], j[0]), cross(j[0], j[1])};  // columns, times the determinant
  for (int k = 0; k < corners; ++k) {
    Vec3d& slope = g.slope[std::size_t(k)];
    for (int d = 0; d < 3; ++d) slope += inverse[d] * (s.slope[std::size_t(k)][std::size_t(d)] / g.determinant);
  }
  return g;
}

}  // namespace gonogo::sim::elastic
