// A solid mesh as a handful of spheres, which the engine's fast path takes: a compound. Host only.
#pragma once
#include <vector>

#include "sim/shape/triangle_mesh.h"

namespace gonogo::sim {

struct CoverSphere {
  Vec3d centre;   // in the axes of the mesh [m]
  double radius;  // [m]
};

struct CoverSettings {
  int count = 20;         // most spheres
  double share = 1;       // of the volume, as the grid sees it, at which to stop [-]
  double protrusion = 0;  // spheres may stick out of the surface so far [m]
  int cells = 24;         // of the grid along the longest side of the box around the mesh
};

struct SphereCover {
  std::vector<CoverSphere> sphere;  // by what each adds to those before it
  double volume_share = 0;          // of the solid that lies in some sphere, by a finer grid [-]
};

/// Distance of a point from the nearest triangle [m], negative outside of the solid: by all triangles, with the sign of
/// the winding number (Van Oosterom & Strackee 1983).
double depth_inside(const TriangleMesh& mesh, const Vec3d& point);

/// The greedy cover: corners and middles of the cells of a cubic grid are candidates, each with the largest sphere
/// about it that stays inside (but for `protrusion`); the one that holds most middles not yet held comes next. It holds
/// at least 1 - 1/e of what the best choice of as many candidates would (Nemhauser et al. 1978). Throws InputError,
/// naming the mesh, for open meshes, those that check_mesh refuses, settings out of range and solids too thin for the
/// grid.
SphereCover cover_by_spheres(const TriangleMesh& mesh, const CoverSettings& settings);

/// Mass properties of a solid of constant density, from its triangles.
struct SolidMoments {
  double volume = 0;       // [m^3]
  Vec3d centre;            // of mass, in the axes of the mesh [m]
  double inertia[3][3]{};  // about the centre over the density, same axes [m^5]
};
SolidMoments moments_of(const TriangleMesh& mesh);

}  // namespace gonogo::sim
