// A sphere on a plane under gravity that leans, for the tests of one sphere and of its regimes.
#pragma once
#include "tests/support/scenes.h"

namespace gonogo::test {

/// Touching a level plane under gravity that leans by `angle` [rad]; radius [m], mass [kg].
inline sim::SceneWorld sphere_on_slope(double angle, double mu, double rolling, double radius = 0.1, double mass = 1) {
  sim::SceneWorld w;
  w.origin = {-60, -5, -1};
  w.size = {110, 10, 2};
  w.gravity = tilted_gravity(angle);
  w.set_law(0, 0, {Real(mu), Real(rolling), 0});
  add_plane(w);
  w.add_sphere({0, 0, radius}, Real(radius), density_for(mass, radius), 0);
  return w;
}

}  // namespace gonogo::test
