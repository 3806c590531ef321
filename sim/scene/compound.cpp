#include "sim/scene/compound.h"

#include <Eigen/Dense>

#include "base/error.h"

namespace gonogo::sim {
namespace {

struct Principal {
  Vec3d inertia;  // over the density [m^5]
  Quat turn;      // from the principal axes to the mesh's
};

Principal principal_axes(const SolidMoments& moments) {
  Eigen::Matrix3d inertia;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) inertia(i, j) = moments.inertia[i][j];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  const Eigen::Quaterniond q(axes);
  const Eigen::Vector3d& values = solver.eigenvalues();
  return {{values[0], values[1], values[2]}, {Real(q.w()), Real(q.x()), Real(q.y()), Real(q.z())}};
}

}  // namespace

BodyIndex add_compound(SceneWorld& world, const BodyState& at, const TriangleMesh& mesh, const SphereCover& cover,
                       double density, int material) {
  const SolidMoments moments = moments_of(mesh);
  if (!(density > 0) || !(moments.volume > 0))
    throw InputError("a compound of the mesh '" + mesh.name + "' needs a density and a volume above zero, not " +
                     std::to_string(density) + " kg/m^3 and " + std::to_string(moments.volume) + " m^3");
  const Principal principal = principal_axes(moments);
  BodyState state = at;
  state.position += static_cast<Vec3d>(rotate(at.orientation, static_cast<Vec3>(moments.centre)));
  state.orientation = normalised(at.orientation * principal.turn);
  const Vec3d inertia = principal.inertia * density;
  const BodyIndex body = world.add_body(state, solid(Real(density * moments.volume), static_cast<Vec3>(inertia)));
  for (const CoverSphere& sphere : cover.sphere) {
    Shape s;
    s.body = body;
    s.material = material;
    s.size = {Real(sphere.radius), 0, 0};
    s.offset_B = rotate_back(principal.turn, static_cast<Vec3>(sphere.centre - moments.centre));
    world.add_shape(s);
  }
  return body;
}

}  // namespace gonogo::sim
