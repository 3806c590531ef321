// What cannot be simulated is refused by a sentence that names it, or does what is written down; it never passes in
// silence. Shapes: shape_check.cpp; meshes: mesh.cpp; bodies that leave or break: watchdog.cpp.
#include <functional>
#include <limits>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();

/// A plane (body 0) and two spheres.
SceneWorld valid_world() {
  SceneWorld w;
  w.origin = {-1, -1, -0.5};
  w.size = {2, 2, 2};
  w.set_law(0, 0, {Real(0.5), 0, 0});
  add_plane(w);
  w.add_sphere({0, 0, 0.1}, 0.1f, 1000, 0);
  w.add_sphere({0.5, 0, 0.1}, 0.1f, 1000, 0);
  return w;
}

std::string refusal(const std::function<void(SceneWorld&)>& spoil) {
  SceneWorld w = valid_world();
  spoil(w);
  return input_error([&] { make_simulation(Backend::cpu, {valid_world(), w}, {}, 1); });
}

std::string settings_refusal(const std::function<void(StepSettings&)>& spoil) {
  StepSettings s;
  spoil(s);
  return input_error([&] { make_simulation(Backend::cpu, {valid_world()}, s, 1); });
}

}  // namespace

TEST_CASE("a mass that is zero, negative or not a number is refused, wherever it comes from") {
  for (const double mass : {0.0, -1.0, kNan}) {
    CHECK(contains(input_error([&] { solid(Real(mass), {1, 1, 1}); }), "a body has the mass"));
    CHECK(contains(input_error([&] { solid(1, {1, Real(mass), 1}); }), "all must be above zero"));
  }
  CHECK(contains(input_error([] { solid(-2, {1, 1, 1}); }), "the mass -2.000000 kg"));
  SceneWorld w;
  CHECK(contains(input_error([&] { w.add_sphere({}, 0.1f, 0, 0); }), "the mass 0.000000 kg"));
  CHECK(contains(input_error([&] { w.add_sphere({}, -0.1f, 1000, 0); }), "the mass -4.18"));
  CHECK(contains(refusal([](SceneWorld& s) { s.mass[1].inverse_mass.z = -0.5f; }),
                 "world 1: body 1 has the inverse mass (0.238732, 0.238732, -0.5) 1/kg"));
  CHECK(contains(refusal([](SceneWorld& s) { s.mass[2].inverse_inertia_B.x = Real(kInfinite); }),
                 "world 1: body 2 has the inverse moments of inertia (inf,"));
  CHECK(contains(refusal([](SceneWorld& s) { s.mass.pop_back(); }), "has 3 bodies and 2 masses"));
  // So light that its inverse is no number any more.
  CHECK(contains(refusal([](SceneWorld& s) { s.mass[1] = solid(1e-39f, {1, 1, 1}); }), "body 1 has the inverse mass"));
}

TEST_CASE("places, motions, gravity and laws that are not finite or out of range are refused") {
  CHECK(contains(refusal([](SceneWorld& s) { s.body[1].position.y = kNan; }),
                 "world 1: body 1: its position is (0, nan, 0.1)"));
  CHECK(contains(refusal([](SceneWorld& s) { s.body[2].velocity.x = Real(kInfinite); }), "body 2: its velocity is"));
  CHECK(contains(refusal([](SceneWorld& s) { s.body[2].angular_velocity.z = Real(kNan); }), "its angular velocity is"));
  CHECK(contains(refusal([](SceneWorld& s) {
                   s.body[1].orientation = {0, 0, 0, 0};
                 }),
                 "the square of its orientation is 0"));
  CHECK(contains(refusal([](SceneWorld& s) { s.gravity.z = Real(kNan); }), "world 1: gravity is (0, 0, nan)"));
  CHECK(contains(refusal([](SceneWorld& s) { s.size.y = kNan; }), "its size must be above zero"));
  CHECK(contains(refusal([](SceneWorld& s) { s.law[1][0].friction = -0.2f; }),
                 "world 1: materials 1 and 0: the friction is -0.2; it must be at least 0"));
  for (Real PairLaw::*part : {&PairLaw::friction, &PairLaw::rolling_friction, &PairLaw::cohesion_pressure,
                              &PairLaw::spinning_friction, &PairLaw::stiffness, &PairLaw::damping}) {
    CHECK(contains(refusal([&](SceneWorld& s) { s.law[0][0].*part = -1; }), "is -1; it must be at least 0"));
    CHECK(contains(refusal([&](SceneWorld& s) { s.law[0][0].*part = Real(kNan); }), "is nan"));
  }
}

TEST_CASE("settings of the step that are out of range are refused") {
  CHECK(settings_refusal([](StepSettings&) {}).empty());
  CHECK(contains(settings_refusal([](StepSettings& s) { s.step = 0; }), "the step is 0 s"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.step = Real(kNan); }), "the step is nan s"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.iterations = 0; }), "iterations are 0"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.substeps = 0; }), "substeps are 0"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.tolerance = -1; }), "the tolerance of the step"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.envelope = -1; }), "the envelope of the step"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.recovery_share = 1.5f; }), "the recovery share is 1.5"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.give = -1; }), "the give of the step"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.give = Real(kNan); }), "the give of the step"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.give_share = 0; }), "the give share is 0"));
  CHECK(contains(settings_refusal([](StepSettings& s) { s.give_share = 1.5f; }), "the give share is 1.5"));
}

TEST_CASE("a body that starts below the domain is flagged in its first step; a fixed one may lie there") {
  for (const Backend backend : backends())
    for (const BodyIndex below : {0, 2}) {
      SceneWorld w = valid_world();
      w.body[std::size_t(below)].position.z = -0.7;
      const auto simulation = simulate(backend, w, {});
      simulation->advance(1);
      CHECK(simulation->report(0).flags == (below == 0 ? 0 : flag_left_domain));
    }
}

TEST_CASE("bodies that leave through an open side or the top go on and still meet each other") {
  for (const Backend backend : backends()) {
    SceneWorld w = valid_world();
    w.gravity = {};
    w.body[1] = {{5, 0, 9}, {}, {1, 0, 0}, {}};
    w.body[2] = {{5.21, 0, 9}, {}, {}, {}};
    const auto simulation = simulate(backend, w, {});
    simulation->advance(50);
    CHECK(simulation->report(0).flags == 0);
    // Equal masses without rebound share the speed.
    CHECK(simulation->body(0, 1).velocity.x == Approx(0.5).epsilon(1e-4));
    CHECK(simulation->body(0, 2).velocity.x == Approx(0.5).epsilon(1e-4));
  }
}

TEST_CASE("an overlapping start without a limit is pushed out no faster than the recovery speed") {
  for (const Backend backend : backends()) {
    SceneWorld w = valid_world();
    w.gravity = {};
    w.body[2].position = {0.12, 0, 0.1};  // 80 mm into the other
    StepSettings settings;
    settings.recovery_speed = 0.3f;
    const auto simulation = simulate(backend, w, settings);
    double fastest = 0;
    for (int i = 0; i < 100; ++i) {
      simulation->advance(10);
      const BodyState a = simulation->body(0, 1), b = simulation->body(0, 2);
      fastest = std::max(fastest, double(b.velocity.x - a.velocity.x));
    }
    CHECK(fastest == Approx(0.3).epsilon(1e-3));
    CHECK(simulation->body(0, 2).position.x - simulation->body(0, 1).position.x > 0.1999);
    CHECK(simulation->report(0).flags == 0);
  }
}

TEST_CASE("a world that cannot run or is too large takes nobody's place") {
  for (const Backend backend : backends()) {
    const auto one = simulate(backend, valid_world(), {}), other = simulate(backend, valid_world(), {});
    SceneWorld bad = valid_world();
    bad.body[1].position.x = kNan;
    CHECK(contains(input_error([&] { one->replace(0, bad); }), "body 1: its position"));
    SceneWorld large = valid_world();
    large.add_sphere({0, 0.5, 0.1}, 0.1f, 1000, 0);
    CHECK(contains(input_error([&] { one->replace(0, large); }), "the new world has 4 bodies, place 0 holds 3"));
    one->advance(20);
    other->advance(20);
    for (BodyIndex b = 0; b < 3; ++b) CHECK(length(one->body(0, b).position - other->body(0, b).position) == 0);
  }
}

TEST_CASE("a batch with more bodies, contacts or bins than can be counted is refused") {
  const Scene two{valid_world(), valid_world()};
  const auto refused_room = [&](const WorldSize& room) {
    return input_error([&] { make_simulation(Backend::cpu, two, {}, 1, room); });
  };
  WorldSize room;
  room.bodies = 2'000'000'000;
  CHECK(contains(refused_room(room), "the batch needs 4000000000 bodies, more than 2147483647; use fewer worlds"));
  room = {};
  room.shapes = 400'000'000;
  CHECK(contains(refused_room(room), "12000000000 places for pairs of shapes"));
  room = {};
  room.bins = 2'000'000'000;
  CHECK(contains(refused_room(room), "4000000000 bins"));
}

TEST_CASE("without a CUDA device the cuda backend is refused with what to do; with one, too large a batch is") {
  if (backends().size() == 1) {
    const std::string said = input_error([] { make_simulation(Backend::cuda, {valid_world()}, {}, 1); });
    CHECK(contains(said, "CUDA"));
    CHECK(contains(said, "ask for the cpu backend"));
    return;
  }
  WorldSize room;
  room.bodies = 2'000'000'000;  // 64 GB for one array of velocities, of which there are three
  try {
    make_simulation(Backend::cuda, {valid_world()}, {}, 1, room);
    FAIL("a batch of 2e9 bodies was accepted");
  } catch (const DeviceError& error) {
    CHECK(contains(error.what(), "out of GPU memory: room for 2000000000 bodies in a world needs "));
  }
  // Nothing of it is left behind.
  const auto simulation = simulate(Backend::cuda, valid_world(), {});
  simulation->advance(10);
  CHECK(simulation->report(0).contact_count == 2);
}
