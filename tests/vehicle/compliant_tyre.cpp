// A compliant tyre on grains gives way by its load over its stiffness.
#include "vehicle/model/statics.h"

#include <cmath>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;

TEST_CASE("a compliant tyre on fixed grains comes to rest its load over its stiffness lower than a rigid one") {
  Wheel tyre;
  tyre.radius = 0.45;
  tyre.width = 0.24;
  tyre.compliant = {.stiffness = 2e5, .damping = 2e4};
  const double mass = 600, load = mass * kGravity, grain = 0.02;
  for (const sim::Backend backend : backends()) {
    double height[2];
    for (const int compliant : {0, 1}) {
      sim::SceneWorld w = open_world({0.8f, 0, 0});
      sim::PairLaw law{0.8f, 0, 0};
      const LinearSpring spring = contact_spring(tyre, load, grain);
      if (compliant) {
        law.stiffness = Real(spring.stiffness);
        law.damping = Real(spring.damping);
      }
      w.set_law(0, 1, law);
      const sim::BodyIndex ground = w.add_body({}, sim::fixed_body());
      sim::Shape s;
      s.body = ground;
      s.size = {Real(grain / 2), 0, 0};
      for (int i = -20; i <= 20; ++i)
        for (int j = -6; j < 6; ++j) {
          s.offset_B = {Real((i + 0.5) * grain), Real((j + 0.5) * grain), Real(-grain / 2)};
          w.add_shape(s);
        }
      s.body = w.add_body({{0, 0, tyre.radius}, {}, {}, {}}, sim::solid(Real(mass), {40, 40, 40}));
      s.type = sim::ShapeType::cylinder;
      s.material = 1;
      s.offset_B = {};
      s.size = {Real(tyre.radius), Real(tyre.width / 2), 0};
      w.add_shape(s);
      const auto simulation = simulate(backend, w, settings_with(100));
      advance_for(*simulation, 1.5);
      height[compliant] = simulation->body(0, 1).position.z;
      CHECK(agrees("load [N]", load, simulation->contact_force(0, 1).z, 0.01 * load));
    }
    // Grains of a twelfth of the tyre's width: the footprint is ten of them long, its edge is not.
    CHECK(agrees("deflection under the load [m]", load / tyre.compliant.stiffness, height[0] - height[1],
                 0.06 * load / tyre.compliant.stiffness));
  }
}
