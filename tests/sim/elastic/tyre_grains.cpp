// A tyre on grains of the engine: forces of the contacts against load, momentum and the ring's own balance.
#include "sim/elastic/tyre/on_grains.h"
#include "sim/scene/penalty_setup.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/scenes.h"

namespace {

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::sim::elastic;

constexpr double kWidth = 0.16, kGrain = 0.02, kLoad = 600;  // width of tyre and bed, radius of a grain [m], [N]

Tyre small_tyre() {
  return {.radius = 0.2,
          .tread = 0.01,
          .rim_radius = 0.12,
          .width = kWidth,
          .bulge = 0.02,
          .pressure = 1e5,
          .bending = 1,
          .stretching = 3e5,
          .tangential = 2e5,
          .belt_mass = 4,
          .loss = 0.1,
          .nodes = 64,
          .law = penalty_law(1e8, 0, 1e-2)};
}

/// Two layers of grains in a square lattice, the upper in the hollows of the lower; periodic along x and y.
GrainGround two_layers() {
  GrainGround g;
  SceneWorld& w = g.world;
  w.origin = {0, 0, -0.05};
  w.size = {0.8, kWidth, 1};
  w.periodic_x = w.periodic_y = true;
  w.set_law(0, 0, {Real(0.6)});
  w.set_law(0, 1, {Real(0.6)});
  test::add_plane(w);
  const double up = kGrain * std::sqrt(2.0);
  for (int layer = 0; layer < 2; ++layer)
    for (int i = 0; i < 20; ++i)
      for (int k = 0; k < 4; ++k)
        w.add_sphere({(2 * i + 1 - layer) * kGrain, (2 * k + 1 - layer) * kGrain, kGrain + layer * up}, Real(kGrain),
                     2600, 0);
  g.settings.contact = gonogo::sim::ContactLaw::spring_damper;
  g.settings.penalty = law_of_overlap(0.02, 1, kGrain, 2600, 0.3);
  g.settings.envelope = Real(1e-3);
  g.settings.cohesion_range = 0;
  g.settings.step = Real(0.5 * critical_step(w, g.settings).step);
  g.material = 1;
  g.x = 0.4;
  g.y = kWidth / 2;
  g.height = kGrain + up + kGrain + 0.201;
  return g;
}

}  // namespace

TEST_CASE("A tyre at rest on grains is borne by them, and so is the ground by the tyre") {
  TyreOnGrains both(small_tyre(), {.load = kLoad, .mass = kLoad / 9.81, .damping = 2000}, two_layers());
  const long steps = std::lround(0.07 / double(both.grains().settings().step));
  both.advance(5 * steps);
  const TreadLoad load = both.advance(steps);
  CHECK(load.upward == Approx(kLoad).epsilon(0.01));
  CHECK(std::fabs(load.forward) < 0.02 * kLoad);
  CHECK(both.tyre().rim_load().y == Approx(kLoad).epsilon(0.01));
  CHECK(std::fabs(both.tyre().torque()) < 0.02 * kLoad * 0.2);
  double last = 0;
  for (const double f : load.force) last += f;
  CHECK(last == Approx(kLoad).epsilon(0.02));
  const double weight = 160 * 4.0 / 3 * kPi * std::pow(kGrain, 3) * 2600 * 9.81;
  CHECK(both.grains().contact_force(0, 0).z == Approx(-kLoad - weight).epsilon(0.02));  // on the plane
  CHECK(both.tyre().rim().y < 0.2 + 0.07);                                              // the tyre gave way
  CHECK(both.tyre().rim().y - both.lowest() < 0.2 - 5e-3);
}

TEST_CASE("A ring that hardly gives way stands on grains as the engine's rigid wheel does") {
  Tyre stiff = small_tyre();
  stiff.radial = stiff.tangential = 2e7;
  stiff.bending = 100;
  stiff.loss = 0.3;
  stiff.pressure = stiff.bulge = 0;
  GrainGround g = two_layers();
  SceneWorld w = g.world;
  BodyMass mass = fixed_body();
  mass.inverse_mass.z = Real(9.81 / kLoad);
  Shape s;
  s.type = ShapeType::wheel;
  s.material = 1;
  s.size = {Real(stiff.radius), Real(kWidth / 2), 0};
  s.body = w.add_body({{g.x, g.y, g.height}, {}, {}, {}}, mass);
  w.add_shape(s);
  StepSettings settings = g.settings;
  settings.step = Real(0.5 * critical_step(w, settings).step);
  const auto wheel = make_simulation(Backend::cpu, {w}, settings, 1);
  wheel->advance(Index(std::lround(0.35 / double(settings.step))));

  TyreOnGrains both(stiff, {.load = kLoad, .mass = kLoad / 9.81, .damping = 4000}, g);
  both.advance(std::lround(0.35 / double(g.settings.step)));
  CHECK(both.tyre().rim().y == Approx(wheel->body(0, s.body).position.z).margin(1e-3));
  CHECK(wheel->body(0, s.body).position.z < g.height - 1.2e-3);  // it did sink in
}

TEST_CASE("A driven tyre pulls on grains as much as they are dragged") {
  TyreOnGrains both(small_tyre(), {.load = kLoad, .mass = kLoad / 9.81, .damping = 2000}, two_layers());
  const long steps = std::lround(0.04 / double(both.grains().settings().step));
  both.advance(6 * steps);
  both.tyre().set_motion(0, -1);
  const TreadLoad load = both.advance(2 * steps);
  CHECK(load.forward > 0.2 * kLoad);
  CHECK(load.forward < 0.65 * kLoad);
  CHECK(-both.tyre().torque() > 0.1 * kLoad * 0.2);
  // The rim takes the pull once the belt has come to rest on it.
  const TreadLoad again = both.advance(2 * steps);
  CHECK(both.tyre().rim_load().x == Approx(again.forward).epsilon(0.25));
}

TEST_CASE("Grains under a tyre take penalty contact only") {
  GrainGround g = two_layers();
  g.settings.contact = gonogo::sim::ContactLaw::complementarity;
  CHECK(input_error([&] { TyreOnGrains(small_tyre(), {.load = 1, .mass = 1}, g); }) ==
        "tyre on grains: the contact must be spring_damper or hertz, whose steps are explicit as the ring's");
}
