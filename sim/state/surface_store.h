// Meshes and heightfields of a batch in the memory of an execution space; see surface.h.
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
