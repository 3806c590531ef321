// A wheel on loose grains.
#pragma once
#include "sim/scene/scene.h"
#include "tests/support/draw.h"
#include "tests/support/scenes.h"

namespace gonogo::test {

/// A lugged wheel driven by a motor and sprung against a mass, on loose grains with friction, rolling and cohesion.
/// Enough grains that every loop of the engine runs on several threads.
inline sim::SceneWorld driven_wheel(std::uint64_t seed) {
  Draw draw(seed);
  using namespace sim;
  SceneWorld w;
  w.origin = {0, 0, -0.1};
  w.size = {0.672, 0.336, 1};
  w.periodic_x = w.periodic_y = true;
  w.set_law(0, 0, {Real(0.5), Real(0.1), 500});
  w.set_law(0, 1, {Real(0.7), 0, 0});
  add_plane(w);
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 6; ++z)
        w.add_sphere(Vec3d{x + 0.5, y + 0.5, z + 0.5} * 0.042 + draw.direction() * 0.001,
                     Real(draw.between(0.019, 0.0215)), 2600, 0);
  sim::Shape s;
  s.type = ShapeType::wheel;
  s.material = 1;
  s.size = {0.2f, 0.08f, 0.03f};
  s.lug_count = 12;
  s.lug_thickness = 0.02f;
  BodyMass hub = solid(10, {1, 0.2f, 1});
  hub.inverse_mass.x = 0.01f;
  hub.inverse_mass.y = hub.inverse_inertia_B.x = hub.inverse_inertia_B.z = 0;
  s.body = w.add_body({{0.33, 0.17, 0.475}, {}, {}, {}}, hub);
  w.add_shape(s);
  BodyMass sprung = solid(50, {1, 1, 1});
  sprung.inverse_mass.x = sprung.inverse_mass.y = 0;
  const BodyIndex mass = w.add_body({{0.33, 0.17, 0.925}, {}, {}, {}}, sprung);
  w.motor.push_back(speed_motor(w, s.body, kWorld, {0, 1, 0}, 3, 100));
  w.spring.push_back(
      spring_along(w, s.body, mass, w.body[s.body].position, w.body[mass].position, {0, 0, -1}, 20000, 800));
  return w;
}

}  // namespace gonogo::test
