#include "sim/elastic/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/error.h"
#include "base/line.h"
#include "sim/elastic/shape_functions.h"

namespace gonogo::sim::elastic {
namespace {

using Corners = std::vector<int>;

/// Faces of an element by its corners, normals outward.
const std::vector<Corners>& face_corners(ElementKind kind) {
  static const std::vector<Corners> t3{{0, 1}, {1, 2}, {2, 0}}, q4{{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  static const std::vector<Corners> t4{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  static const std::vector<Corners> h8{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                       {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  switch (kind) {
    case ElementKind::t3:
      return t3;
    case ElementKind::q4:
      return q4;
    case ElementKind::t4:
      return t4;
    default:
      return h8;
  }
}

std::array<Index, 4> key_of(const Face& f) {
  std::array<Index, 4> key = f.node;
  std::sort(key.begin(), key.end());
  return key;
}

Vec3d centre_of(const Mesh& mesh, const Face& f) {
  Vec3d sum;
  for (int k = 0; k < f.count; ++k) sum += mesh.node[std::size_t(f.node[k])];
  return sum * (1.0 / f.count);
}

std::string place(const std::string& name, std::size_t e) { return name + ": element " + std::to_string(e); }

void check_corners(const Mesh& mesh, const std::string& name, std::vector<bool>& used) {
  const int corners = corner_count(mesh.kind);
  for (std::size_t e = 0; e < mesh.element.size(); ++e)
    for (int k = 0; k < corners; ++k) {
      const Index n = mesh.element[e][std::size_t(k)];
      if (n < 0 || std::size_t(n) >= mesh.node.size())
        throw InputError(place(name, e) + " has corner " + std::to_string(n) + "; nodes are 0 to " +
                         std::to_string(mesh.node.size() - 1));
      for (int j = 0; j < k; ++j)
        if (mesh.element[e][std::size_t(j)] == n)
          throw InputError(place(name, e) + " has node " + std::to_string(n) + " twice; an element needs " +
                           std::to_string(corners) + " different corners");
      used[std::size_t(n)] = true;
    }
}

double size_of(const Mesh& mesh, std::size_t e) {
  double size = 0;
  for (int k = 1; k < corner_count(mesh.kind); ++k)
    size = std::max(size, length(mesh.node[std::size_t(mesh.element[e][std::size_t(k)])] -
                                 mesh.node[std::size_t(mesh.element[e][0])]));
  return size;
}

void check_volumes(const Mesh& mesh, const std::string& name) {
  for (std::size_t e = 0; e < mesh.element.size(); ++e) {
    const double least = 1e-12 * std::pow(size_of(mesh, e), dimension_of(mesh.kind));
    for (const QuadraturePoint& q : quadrature_of(mesh.kind)) {
      const double d = gradient_of(mesh, e, shape_values(mesh.kind, q.at)).determinant;
      if (d > least) continue;
      throw InputError(place(name, e) + (d < -least ? " is inverted" : " is degenerate") +
                       line(": the determinant of its Jacobian is %.3g, allowed is above %.3g; ", d, least) +
                       "order its corners counter-clockwise or as VTK does, and mesh again where it is flat");
    }
  }
}

}  // namespace

int dimension_of(ElementKind kind) { return kind == ElementKind::t3 || kind == ElementKind::q4 ? 2 : 3; }

int corner_count(ElementKind kind) { return kind == ElementKind::t3 ? 3 : kind == ElementKind::h8 ? 8 : 4; }

std::string name_of(ElementKind kind) {
  static const char* const names[] = {"t3", "q4", "t4", "h8"};
  return names[std::size_t(kind)];
}

std::vector<Face> boundary_faces(const Mesh& mesh) {
  std::vector<Face> all;
  for (std::size_t e = 0; e < mesh.element.size(); ++e)
    for (const Corners& corners : face_corners(mesh.kind)) {
      Face f;
      f.element = Index(e);
      for (const int c : corners) f.node[std::size_t(f.count++)] = mesh.element[e][std::size_t(c)];
      all.push_back(f);
    }
  std::map<std::array<Index, 4>, int> times;
  for (const Face& f : all) ++times[key_of(f)];
  std::vector<Face> once;
  for (const Face& f : all)
    if (times[key_of(f)] == 1) once.push_back(f);
  return once;
}

std::vector<Face> faces_where(const Mesh& mesh, const At& at) {
  std::vector<Face> found;
  for (const Face& f : boundary_faces(mesh))
    if (at(centre_of(mesh, f))) found.push_back(f);
  if (found.empty()) throw InputError("no face of the mesh's boundary is at the place asked for; check the condition");
  return found;
}

std::vector<Index> nodes_where(const Mesh& mesh, const At& at) {
  std::vector<Index> found;
  for (std::size_t i = 0; i < mesh.node.size(); ++i)
    if (at(mesh.node[i])) found.push_back(Index(i));
  if (found.empty()) throw InputError("no node of the mesh is at the place asked for; check the condition");
  return found;
}

std::vector<Index> nodes_of(const std::vector<Face>& faces) {
  std::vector<Index> nodes;
  for (const Face& f : faces) nodes.insert(nodes.end(), f.node.begin(), f.node.begin() + f.count);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

Box box_of(const Mesh& mesh) {
  Box box{mesh.node.at(0), mesh.node.at(0)};
  for (const Vec3d& x : mesh.node) {
    box.low = {std::min(box.low.x, x.x), std::min(box.low.y, x.y), std::min(box.low.z, x.z)};
    box.high = {std::max(box.high.x, x.x), std::max(box.high.y, x.y), std::max(box.high.z, x.z)};
  }
  return box;
}

void check_mesh(const Mesh& mesh, const std::string& name) {
  if (mesh.element.empty() || mesh.node.empty())
    throw InputError(name + ": the mesh has no element; give at least one");
  std::vector<bool> used(mesh.node.size(), false);
  check_corners(mesh, name, used);
  const auto lone = std::find(used.begin(), used.end(), false);
  if (lone != used.end())
    throw InputError(name + ": node " + std::to_string(lone - used.begin()) +
                     " belongs to no element and could move freely; remove it");
  check_volumes(mesh, name);
}

}  // namespace gonogo::sim::elastic
