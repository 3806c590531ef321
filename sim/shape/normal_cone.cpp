#include "sim/shape/normal_cone.h"

#include <algorithm>
#include <cmath>

namespace gonogo::sim {
namespace {

/// Unit outward normals.
std::vector<Vec3d> normals_of(const std::vector<MeshTriangle>& triangle, const std::vector<Vec3>& vertex) {
  std::vector<Vec3d> normal;
  for (const MeshTriangle& t : triangle) {
    const auto corner = [&](int k) { return static_cast<Vec3d>(vertex[t.vertex[k]]); };
    const Vec3d n = cross(corner(1) - corner(0), corner(2) - corner(0));
    normal.push_back(n * (1 / length(n)));
  }
  return normal;
}

bool has_rim(const MeshTriangle& t) { return t.neighbour[0] < 0 || t.neighbour[1] < 0 || t.neighbour[2] < 0; }

bool has_valley(const MeshTriangle& t) { return (t.marks & (MeshMark::valley * 7)) != 0; }

/// About the mean of the normals of triangles `begin` to `end` and their neighbours.
NormalCone cone_around(const std::vector<MeshTriangle>& triangle, const std::vector<Vec3d>& normal, Index begin,
                       Index end) {
  Vec3d sum;
  bool hollow = false;
  for (Index t = begin; t < end; ++t) {
    if (has_rim(triangle[t])) return {};
    hollow = hollow || has_valley(triangle[t]);
    sum += normal[t];
  }
  if (length(sum) < 1e-3 * (end - begin)) return {};
  const Vec3d axis = sum * (1 / length(sum));
  double least = 1;
  for (Index t = begin; t < end; ++t) {
    least = std::min(least, dot(axis, normal[t]));
    for (const Index other : triangle[t].neighbour) least = std::min(least, dot(axis, normal[other]));
  }
  if (least < 1e-3) return {};
  return {static_cast<Vec3>(axis), Real(hollow ? 1e-6 - least : least - 1e-6)};
}

}  // namespace

std::vector<NormalCone> normal_cones(const MeshNode* node, Index nodes, const std::vector<MeshTriangle>& triangle,
                                     const std::vector<Vec3>& vertex) {
  const std::vector<Vec3d> normal = normals_of(triangle, vertex);
  std::vector<NormalCone> cone;
  for (Index n = 0; n < nodes; ++n) {
    const Index end = node[n].skip < nodes ? node[node[n].skip].first : Index(triangle.size());
    cone.push_back(cone_around(triangle, normal, node[n].first, end));
  }
  return cone;
}

}  // namespace gonogo::sim
