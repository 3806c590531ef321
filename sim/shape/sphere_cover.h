// Approximates a solid mesh by spheres, for a compound on the engine's fast path. Host only.
#pragma once
#include <vector>

#include "sim/shape/triangle_mesh.h"

namespace gonogo::sim {

struct CoverSphere {
  Vec3d centre;   // in the axes of the mesh [m]
  double radius;  // [m]
};

struct CoverSettings {
  int count = 20;         // max spheres
  double share = 1;       // covered share of the volume, on the grid, at which to stop [-]
  double protrusion = 0;  // max distance of spheres beyond the surface [m]
  int cells = 24;         // of the grid along the longest side of the mesh's bounding box
};

struct SphereCover {
  std::vector<CoverSphere> sphere;  // in the order in which they were chosen
  double volume_share = 0;          // share of the solid inside the spheres, on a finer grid [-]
};

/// Distance of a point from the nearest triangle [m], negative outside of the solid. The sign follows from the winding
/// number (Van Oosterom & Strackee 1983).
double depth_inside(const TriangleMesh& mesh, const Vec3d& point);

/// A greedy cover. Candidates are the corners and middles of the cells of a cubic grid, each with the largest sphere
/// that stays inside, apart from `protrusion`. The next sphere is the one that covers most middles not yet covered. The
/// cover holds at least 1 - 1/e of the best choice of as many candidates (Nemhauser et al. 1978). Throws InputError,
/// naming the mesh, for open meshes, meshes that check_mesh refuses, settings out of range and solids too thin for the
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
