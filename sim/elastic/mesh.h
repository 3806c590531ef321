// Meshes of elastic bodies: nodes, elements of one kind, named parts of the boundary.
#pragma once
#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/vec.h"

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
/// Those whose centre is `at`. Throws InputError when there is none.
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

}  // namespace gonogo::sim::elastic
