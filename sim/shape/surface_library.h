// Meshes and heightfields of a batch as flat arrays for kernels: neighbours, trees of boxes, names of coplanar faces.
// Surfaces shared by several worlds are stored once. SurfaceLibrary is on the host, SurfaceStore where the kernels run.
#pragma once
#include <memory>
#include <vector>

#include "base/parallel/buffer.h"
#include "sim/shape/surface.h"
#include "sim/shape/triangle_mesh.h"

namespace gonogo::sim {

class SurfaceLibrary {
 public:
  /// Adds a mesh, unless it is there already; returns its index in the batch. It must have passed check_mesh.
  Index add(const std::shared_ptr<const TriangleMesh>& source);
  Index add(const std::shared_ptr<const Heightfield>& source);

  /// Number of meshes and heightfields.
  Index size() const { return Index(mesh.size() + field.size()); }

  std::vector<MeshRange> mesh;
  std::vector<MeshNode> node;
  std::vector<NormalCone> cone;  // [node]
  std::vector<MeshTriangle> triangle;
  std::vector<Vec3> vertex;
  std::vector<FieldRange> field;
  std::vector<Real> height;
  std::vector<Index> name;  // of the triangles of heightfields

  SurfaceView view() const;  // for code that runs on the host

 private:
  std::vector<std::shared_ptr<const TriangleMesh>> mesh_source_;
  std::vector<std::shared_ptr<const Heightfield>> field_source_;
};

/// The same arrays in the memory of an execution space.
template <class Exec>
struct SurfaceStore {
  Buffer<MeshRange, Exec> mesh;
  Buffer<MeshNode, Exec> node;
  Buffer<NormalCone, Exec> cone;
  Buffer<MeshTriangle, Exec> triangle;
  Buffer<Vec3, Exec> vertex;
  Buffer<FieldRange, Exec> field;
  Buffer<Real, Exec> height;
  Buffer<Index, Exec> name;

  /// Number of meshes and heightfields.
  Index size() const { return mesh.size() + field.size(); }

  SurfaceView view() {
    return {.mesh = mesh.view(),
            .node = node.view(),
            .cone = cone.view(),
            .triangle = triangle.view(),
            .vertex = vertex.view(),
            .field = field.view(),
            .height = height.view(),
            .name = name.view()};
  }

  void upload(const SurfaceLibrary& library) {
    mesh.upload(library.mesh);
    node.upload(library.node);
    cone.upload(library.cone);
    triangle.upload(library.triangle);
    vertex.upload(library.vertex);
    field.upload(library.field);
    height.upload(library.height);
    name.upload(library.name);
  }
};

}  // namespace gonogo::sim
