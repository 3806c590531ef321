#include "sim/scene/scene.h"

#include <string>
#include <utility>

#include "base/error.h"
#include "base/units.h"

namespace gonogo::sim {

BodyMass fixed_body() { return {}; }

BodyMass solid(Real mass, const Vec3& inertia_B) {
  if (!(mass > 0) || !(inertia_B.x > 0) || !(inertia_B.y > 0) || !(inertia_B.z > 0))
    throw InputError("a body has the mass " + std::to_string(mass) + " kg and the moments of inertia " +
                     std::to_string(inertia_B.x) + ", " + std::to_string(inertia_B.y) + ", " +
                     std::to_string(inertia_B.z) +
                     " kg m^2; all must be above zero, or use fixed_body() for a body that stays");
  BodyMass m;
  m.inverse_mass = {1 / mass, 1 / mass, 1 / mass};
  m.inverse_inertia_B = {1 / inertia_B.x, 1 / inertia_B.y, 1 / inertia_B.z};
  m.isotropic = inertia_B.x == inertia_B.y && inertia_B.y == inertia_B.z;
  return m;
}

BodyIndex SceneWorld::add_body(const BodyState& state, const BodyMass& body_mass) {
  body.push_back(state);
  mass.push_back(body_mass);
  return BodyIndex(body.size()) - 1;
}

BodyIndex SceneWorld::add_sphere(const Vec3d& position, Real radius, Real density, int material) {
  const Real m = density * Real(4.0 / 3.0 * kPi) * radius * radius * radius;
  const Real inertia = Real(0.4) * m * radius * radius;
  const BodyIndex b = add_body({position, {}, {}, {}}, solid(m, {inertia, inertia, inertia}));
  Shape s;
  s.body = b;
  s.material = material;
  s.size = {radius, 0, 0};
  add_shape(s);
  return b;
}

BodyIndex SceneWorld::add_ellipsoid(const BodyState& state, const Vec3& half, Real density, int material) {
  const double x = double(half.x) * half.x, y = double(half.y) * half.y, z = double(half.z) * half.z;
  const double m = double(density) * 4.0 / 3.0 * kPi * half.x * half.y * half.z;
  const Vec3 inertia{Real(m / 5 * (y + z)), Real(m / 5 * (x + z)), Real(m / 5 * (x + y))};
  const BodyIndex b = add_body(state, solid(Real(m), inertia));
  Shape s;
  s.type = ShapeType::ellipsoid;
  s.body = b;
  s.material = material;
  s.size = half;
  add_shape(s);
  return b;
}

void SceneWorld::add_shape(const Shape& s) {
  if (s.body < 0 || s.body >= BodyIndex(body.size()) || (!shape.empty() && shape.back().body > s.body))
    throw InputError("shapes must be added in ascending order of their body, after it exists");
  shape.push_back(s);
}

std::int32_t SceneWorld::add_mesh(TriangleMesh m) {
  check_mesh(m);
  mesh.push_back(std::make_shared<const TriangleMesh>(std::move(m)));
  return std::int32_t(mesh.size()) - 1;
}

std::int32_t SceneWorld::add_heightfield(Heightfield f) {
  check_heightfield(f);
  heightfield.push_back(std::make_shared<const Heightfield>(std::move(f)));
  return std::int32_t(heightfield.size()) - 1;
}

void SceneWorld::set_law(int material_a, int material_b, const PairLaw& l) {
  law[material_a][material_b] = l;
  law[material_b][material_a] = l;
}

void SceneWorld::set_penalty(int material_a, int material_b, const PenaltyLaw& l) {
  penalty[material_a][material_b] = l;
  penalty[material_b][material_a] = l;
}

}  // namespace gonogo::sim
