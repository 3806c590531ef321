// Meshes of elastic bodies: nodes, elements of one kind, named parts of the boundary; how to make them; shape
// functions.
#pragma once
#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/math/vec.h"

namespace gonogo::sim::elastic {

/// Linear triangle, bilinear quadrilateral, linear tetrahedron, trilinear hexahedron; corners in VTK's order.
enum class ElementKind { t3, q4, t4, h8 };

int dimension_of(ElementKind kind);  // 2 or 3
int corner_count(ElementKind kind);  // 3, 4, 4, 8
std::string name_of(ElementKind kind);

/// An edge (2-D) or face (3-D) of the boundary. Its corners run so that the normal points out of the body.
struct Face {
  std::array<Index, 4> node{-1, -1, -1, -1};
  int count = 0;  // 2, 3 or 4
  Index element = -1;
};

struct Mesh {
  ElementKind kind = ElementKind::q4;
  std::vector<Vec3d> node;                           // [m]; 2-D: z = 0; axisymmetric: x is the radius, y the axis
  std::vector<std::array<Index, 8>> element;         // the first corner_count(kind) count
  std::map<std::string, std::vector<Face>> group{};  // named parts of the boundary
};

using At = std::function<bool(const Vec3d&)>;

/// Faces that belong to one element only, in the order of elements.
std::vector<Face> boundary_faces(const Mesh& mesh);
/// Boundary faces whose centre is `at`. Throws InputError when there is none.
std::vector<Face> faces_where(const Mesh& mesh, const At& at);
/// Nodes that are `at`. Throws InputError when there is none.
std::vector<Index> nodes_where(const Mesh& mesh, const At& at);
std::vector<Index> nodes_of(const std::vector<Face>& faces);

/// Largest and smallest x, y, z of the nodes [m].
struct Box {
  Vec3d low, high;
};
Box box_of(const Mesh& mesh);

/// Throws InputError for an empty mesh, corners that do not exist or repeat, inverted or degenerate elements (volume at
/// a quadrature point at most 1e-12 of the element's size to the power of the dimension) and nodes of no element.
void check_mesh(const Mesh& mesh, const std::string& name);

// Structured meshes, graded where wanted.

/// `count` equal steps from `from` to `to`: count + 1 places. Throws InputError unless from < to and count >= 1.
std::vector<double> even(double from, double to, int count);
/// Equal steps of `first` up to `fine_until`, then steps that grow by `ratio` (above 1, at most 3) up to `to`.
/// Throws InputError for other numbers.
std::vector<double> graded(double from, double fine_until, double to, double first, double ratio);
/// The same places mirrored at the origin, in ascending order.
std::vector<double> mirrored(const std::vector<double>& places);

/// Rectangle with nodes at every pair of places; t3 halves each quadrilateral, along alternating diagonals.
Mesh make_rectangle(const std::vector<double>& x, const std::vector<double>& y, ElementKind kind = ElementKind::q4);
/// Box; t4 cuts each hexahedron into six tetrahedra (Kuhn).
Mesh make_box(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z,
              ElementKind kind = ElementKind::h8);
/// Sector of a ring between radii [m], first at least above 0, and angles [rad] counter-clockwise from x.
Mesh make_ring_sector(const std::vector<double>& radius, const std::vector<double>& angle,
                      ElementKind kind = ElementKind::q4);
/// Sector of a hollow cylinder about z.
Mesh make_cylinder_sector(const std::vector<double>& radius, const std::vector<double>& angle,
                          const std::vector<double>& z, ElementKind kind = ElementKind::h8);
/// Quarter of a disc about the origin, x >= 0 and y <= 0. `across` and `up` are places in a square that is bent onto
/// the disc: across in [0, 1] from the axis, up in [-1, 0] from the arc. Elliptical grid mapping (Nowell; Fong 2015):
/// x = R u sqrt(1 - v^2 / 2), y = R v sqrt(1 - u^2 / 2); the arc's lower half is v = -1.
Mesh make_quarter_disc(double radius, const std::vector<double>& across, const std::vector<double>& up);

/// The mesh with every node moved. Faces of groups stay.
Mesh moved(Mesh mesh, const std::function<Vec3d(const Vec3d&)>& to);

// Shape functions and quadrature of the elements; Hughes, The Finite Element Method, 2000, chapter 3.

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

/// Quadrature of a face with 2, 3 or 4 corners. Weights add up to 1 for triangles' area and segments' length of 1, to 4
/// for quads.
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
