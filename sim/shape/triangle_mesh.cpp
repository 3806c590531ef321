#include "sim/shape/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/format.h"
#include "sim/shape/shape.h"

namespace gonogo::sim {
namespace {

/// Names of contacts hold 8 features of a triangle, and capsules 4 of those.
constexpr std::size_t kMaxTriangles = std::size_t(1) << 25;

std::string text(const Vec3& p) { return line("(%g, %g, %g)", double(p.x), double(p.y), double(p.z)); }

[[noreturn]] void refuse(const TriangleMesh& mesh, const std::string& why) {
  throw InputError("mesh \"" + mesh.name + "\": " + why);
}

std::string edge_text(const TriangleMesh& mesh, Index a, Index b) {
  return "the edge from vertex " + std::to_string(a) + " " + text(mesh.vertex[a]) + " to vertex " + std::to_string(b) +
         " " + text(mesh.vertex[b]);
}

void check_triangle(const TriangleMesh& mesh, std::size_t t) {
  const auto& corner = mesh.triangle[t];
  const std::string which = "triangle " + std::to_string(t);
  for (const Index v : corner)
    if (v < 0 || v >= Index(mesh.vertex.size()))
      refuse(mesh, which + " has the vertex " + std::to_string(v) + ", there are " +
                       std::to_string(mesh.vertex.size()) + "; vertices are counted from 0");
  const auto a = static_cast<Vec3d>(mesh.vertex[corner[0]]), b = static_cast<Vec3d>(mesh.vertex[corner[1]]),
             c = static_cast<Vec3d>(mesh.vertex[corner[2]]);
  const double longest = std::max({length(b - a), length(c - a), length(c - b)});
  // A height below 1e-5 of the longest side leaves float no direction for the normal.
  if (!(length(cross(b - a, c - a)) > 1e-5 * longest * longest))
    refuse(mesh, which + " at " + text(mesh.vertex[corner[0]]) + " is degenerate: its corners lie on a line");
}

/// Every directed edge once, and its opposite once unless the mesh is open.
void check_edges(const TriangleMesh& mesh) {
  std::map<std::pair<Index, Index>, int> uses, any_way;
  for (const auto& corner : mesh.triangle)
    for (int k = 0; k < 3; ++k) {
      const Index a = corner[k], b = corner[(k + 1) % 3];
      ++uses[{a, b}];
      ++any_way[{std::min(a, b), std::max(a, b)}];
    }
  for (const auto& [edge, count] : any_way)
    if (count > 2)
      refuse(mesh, edge_text(mesh, edge.first, edge.second) + " belongs to " + std::to_string(count) +
                       " triangles; two are allowed");
  for (const auto& [edge, count] : uses) {
    if (count > 1)
      refuse(mesh, "two triangles run the same way along " + edge_text(mesh, edge.first, edge.second) +
                       "; neighbours must be wound alike");
    if (!mesh.open && uses.count({edge.second, edge.first}) == 0)
      refuse(mesh, edge_text(mesh, edge.first, edge.second) +
                       " belongs to one triangle only: the mesh is not closed; close it, or mark it open to use it as "
                       "one-sided ground");
  }
}

double six_volumes(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangle)
    sum += dot(static_cast<Vec3d>(mesh.vertex[a]),
               cross(static_cast<Vec3d>(mesh.vertex[b]), static_cast<Vec3d>(mesh.vertex[c])));
  return sum;
}

}  // namespace

void check_mesh(const TriangleMesh& mesh) {
  if (mesh.vertex.empty() || mesh.triangle.empty()) refuse(mesh, "it is empty");
  if (mesh.triangle.size() > kMaxTriangles)
    refuse(mesh, "it has " + std::to_string(mesh.triangle.size()) + " triangles, at most " +
                     std::to_string(kMaxTriangles) + " are possible");
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v)
    if (!is_finite(mesh.vertex[v])) refuse(mesh, "vertex " + std::to_string(v) + " is not finite");
  for (std::size_t t = 0; t < mesh.triangle.size(); ++t) check_triangle(mesh, t);
  check_edges(mesh);
  if (!mesh.open && !(six_volumes(mesh) > 0))
    refuse(mesh, "it is inside out; turn all its triangles, so that they run counterclockwise seen from outside");
}

void check_heightfield(const Heightfield& field) {
  const std::string which = "heightfield \"" + field.name + "\": ";
  if (field.nx < 2 || field.ny < 2)
    throw InputError(which + "it has " + std::to_string(field.nx) + " by " + std::to_string(field.ny) +
                     " heights; at least 2 by 2 are needed");
  if (!(field.spacing_x > 0 && field.spacing_y > 0)) throw InputError(which + "its spacing must be above zero");
  const std::size_t count = std::size_t(field.nx) * std::size_t(field.ny);
  if (field.height.size() != count || count > kMaxTriangles / 2)
    throw InputError(which + "it has " + std::to_string(field.height.size()) + " heights, its " +
                     std::to_string(field.nx) + " by " + std::to_string(field.ny) + " grid needs " +
                     std::to_string(count) + ", and at most " + std::to_string(kMaxTriangles / 2) + " are possible");
  for (std::size_t i = 0; i < count; ++i)
    if (!std::isfinite(field.height[i])) throw InputError(which + "height " + std::to_string(i) + " is not finite");
}

Real reach_of(const TriangleMesh& mesh) {
  Real reach = 0;
  for (const Vec3& p : mesh.vertex) reach = std::max(reach, length(p));
  return reach;
}

Real min_half_of(const TriangleMesh& mesh) {
  Vec3 low = mesh.vertex.front(), high = low;
  for (const Vec3& p : mesh.vertex) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return std::min({high.x - low.x, high.y - low.y, high.z - low.z}) / 2;
}

Real reach_of(const Heightfield& field) {
  Real highest = 0;
  for (const Real h : field.height) highest = std::max(highest, std::fabs(h));
  return length(Vec3{Real(field.nx - 1) * field.spacing_x / 2, Real(field.ny - 1) * field.spacing_y / 2, highest});
}

}  // namespace gonogo::sim
