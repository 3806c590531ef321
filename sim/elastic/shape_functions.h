// Shape functions and quadrature of the elements; Hughes, The Finite Element Method, 2000, chapter 3.
#pragma once
#include <array>
#include <vector>

#include "sim/elastic/mesh.h"

namespace gonogo::sim::elastic {

struct ShapeValues {
  std::array<double, 8> n{};                     // value of each corner's function
  std::array<std::array<double, 3>, 8> slope{};  // by local coordinates
};

struct QuadraturePoint {
  std::array<double, 3> at{};  // local coordinates
  double weight = 0;
};

ShapeValues shape_values(ElementKind kind, const std::array<double, 3>& at);
/// Exact for squares of the functions on undistorted elements: 3, 4, 4 and 8 points.
const std::vector<QuadraturePoint>& quadrature_of(ElementKind kind);

/// Of a face with 2, 3 or 4 corners. Weights add up to 1 for triangles' area and segments' length of 1, to 4 for quads.
struct FacePoint {
  std::array<double, 4> n{};
  std::array<std::array<double, 2>, 4> slope{};
  double weight = 0;
};
/// `points` along each direction, 1 to 5; triangles: 1, 3, 3, 6, 6 in all.
std::vector<FacePoint> face_quadrature(int corners, int points);
FacePoint face_values(int corners, double xi, double eta);

/// Length or area per unit of the local coordinates, at a point of a face in place `x` [corners].
double face_measure(int corners, const FacePoint& p, const std::array<Vec3d, 4>& x);

/// Jacobian's determinant and the functions' slopes in space, [1/m].
struct Gradient {
  double determinant = 0;
  std::array<Vec3d, 8> slope{};
};
Gradient gradient_of(const Mesh& mesh, std::size_t element, const ShapeValues& values);

}  // namespace gonogo::sim::elastic
