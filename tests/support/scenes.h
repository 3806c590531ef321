// Building blocks of test scenes.
#pragma once
#include <cmath>
#include <memory>

#include "base/units.h"
#include "sim/simulation/simulation.h"
#include "tests/support/draw.h"

namespace gonogo::test {

inline Quat about_x(double angle) { return {Real(std::cos(angle / 2)), Real(std::sin(angle / 2)), 0, 0}; }
inline Quat about_y(double angle) { return {Real(std::cos(angle / 2)), 0, Real(std::sin(angle / 2)), 0}; }

/// Column, row and layer of the k-th place of a grid with so many columns and rows.
inline Vec3d grid_place(int k, int columns, int rows) {
  const int row = k / columns % rows, layer = k / (columns * rows);
  return {double(k % columns), double(row), double(layer)};
}

/// Fixed plane through `centre`; its normal is the z axis of `orientation`.
inline sim::BodyIndex add_plane(sim::SceneWorld& world, const Vec3d& centre = {}, const Quat& orientation = {},
                                int material = 0) {
  const sim::BodyIndex b = world.add_body({centre, orientation, {}, {}}, sim::fixed_body());
  sim::Shape s;
  s.type = sim::ShapeType::plane;
  s.body = b;
  s.material = material;
  world.add_shape(s);
  return b;
}

/// Solid box with the given half edges [m].
inline sim::BodyIndex add_box(sim::SceneWorld& world, const sim::BodyState& state, const Vec3& half, double mass,
                              int material = 0) {
  const double x = half.x * half.x, y = half.y * half.y, z = half.z * half.z;
  const Vec3 inertia{Real(mass / 3 * (y + z)), Real(mass / 3 * (x + z)), Real(mass / 3 * (x + y))};
  const sim::BodyIndex b = world.add_body(state, sim::solid(Real(mass), inertia));
  sim::Shape s;
  s.type = sim::ShapeType::box;
  s.body = b;
  s.material = material;
  s.size = half;
  world.add_shape(s);
  return b;
}

/// Density that gives a sphere this mass [kg/m^3].
inline Real density_for(double mass, double radius) {
  return Real(mass / (4.0 / 3.0 * kPi * radius * radius * radius));
}

/// Gravity as felt on ground that rises along +x at `angle`.
inline Vec3 tilted_gravity(double angle) {
  return {Real(-kGravity * std::sin(angle)), 0, Real(-kGravity * std::cos(angle))};
}

inline sim::StepSettings settings_with(Index iterations) {
  sim::StepSettings s;
  s.iterations = iterations;
  return s;
}
inline sim::StepSettings settings_with(double step, Index iterations, sim::Target target = sim::Target::ccp) {
  sim::StepSettings s = settings_with(iterations);
  s.step = Real(step);
  s.target = target;
  return s;
}

/// Nothing yet, within 5 m of the origin.
inline sim::SceneWorld open_world(const sim::PairLaw& law) {
  sim::SceneWorld w;
  w.origin = {-5, -5, -5};
  w.size = {10, 10, 10};
  w.set_law(0, 0, law);
  return w;
}

inline constexpr double kBlockHalf = 0.1;  // half edge of the block on a slope [m]

/// Gravity leans by `angle` over a level plane; the block is body 1 and stands on it.
inline sim::SceneWorld block_on_slope(double angle, double mu, double mass) {
  sim::SceneWorld w;
  w.origin = {-50, -5, -1};
  w.size = {100, 10, 3};
  w.gravity = tilted_gravity(angle);
  w.set_law(0, 0, {Real(mu), 0, 0});
  add_plane(w);
  const Real half = Real(kBlockHalf);
  add_box(w, {{0, 0, kBlockHalf}, {}, {}, {}}, {half, half, half}, mass);
  return w;
}

inline std::unique_ptr<sim::Simulation> simulate(sim::Backend backend, const sim::SceneWorld& world,
                                                 const sim::StepSettings& settings) {
  return sim::make_simulation(backend, {world}, settings, 1);
}

/// Takes as many steps as fit into `seconds`, rounded to nearest.
inline void advance_for(sim::Simulation& simulation, double seconds) {
  simulation.advance(Index(std::lround(seconds / simulation.settings().step)));
}

}  // namespace gonogo::test
