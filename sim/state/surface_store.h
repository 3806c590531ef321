// Meshes and heightfields of a batch where the kernels run. See surface.h.
#pragma once
#include "base/buffer.h"
#include "sim/shape/surface_library.h"

namespace gonogo::sim {

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
    return {mesh.view(),   node.view(),  cone.view(),   triangle.view(),
            vertex.view(), field.view(), height.view(), name.view()};
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
