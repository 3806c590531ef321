// Cones of normals for the nodes of a mesh's tree. Host only.
#pragma once
#include <vector>

#include "sim/shape/surface.h"

namespace gonogo::sim {

/// [node] For the nodes of one mesh, depth first, and its triangles in the order of their leaves, marked and with
/// neighbours.
std::vector<NormalCone> normal_cones(const MeshNode* node, Index nodes, const std::vector<MeshTriangle>& triangle,
                                     const std::vector<Vec3>& vertex);

}  // namespace gonogo::sim
