// Vertices of a mesh that is assembled from separate triangles.
#pragma once
#include <map>
#include <tuple>

#include "sim/shape/triangle_mesh.h"

namespace gonogo::sim {

/// Adds each vertex once, by its exact position.
class Welder {
 public:
  explicit Welder(TriangleMesh& mesh) : mesh_(mesh) {}
  Index add(const Vec3& p) {
    const auto [at, is_new] = index_.try_emplace({p.x, p.y, p.z}, Index(mesh_.vertex.size()));
    if (is_new) mesh_.vertex.push_back(p);
    return at->second;
  }

 private:
  TriangleMesh& mesh_;
  std::map<std::tuple<Real, Real, Real>, Index> index_;
};

}  // namespace gonogo::sim
