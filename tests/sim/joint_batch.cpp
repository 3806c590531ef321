// Jointed worlds in batches: bits that depend on nothing else, and refusal of what cannot work.
#include <cmath>
#include <cstring>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// A cart of a box on two wheel pairs, driven over a plane beside a swinging pendulum: two mechanisms.
SceneWorld cart(double speed, int pairs) {
  SceneWorld w;
  w.origin = {-5, -5, -1};
  w.size = {10, 10, 4};
  w.set_law(0, 0, {Real(0.7), 0, 0});
  const BodyIndex ground = add_plane(w);
  const BodyIndex frame = w.add_body({{0, 0, 0.4}, {}, {}, {}}, solid(40, {4, 6, 8}));
  for (int k = 0; k < 2 * pairs; ++k) {
    const int pair = k / 2;
    const Vec3d at{0.5 * pair, k % 2 ? 0.4 : -0.4, 0.2};
    const BodyIndex wheel = w.add_sphere(at, 0.2f, 200, 0);
    w.joint.push_back(revolute(w, wheel, frame, at, {0, 1, 0}));
    w.motor.push_back(speed_motor(w.joint.back(), speed, 20));
  }
  const BodyIndex bob = w.add_sphere({2, 2, 1}, 0.1f, 1000, 0);
  w.joint.push_back(spherical(w, bob, ground, {2.5, 2, 1.5}));
  w.spring.push_back(spring_between(w, bob, ground, {2, 2, 1}, {2, 2, 2}, 200, 1));
  return w;
}

StepSettings few_iterations() {
  StepSettings s;
  s.iterations = 20;
  return s;
}

bool same_load(const JointLoad& a, const JointLoad& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

TEST_CASE("a jointed world has the same bits alone and in a batch, for any number of threads") {
  const Scene batch{cart(3, 2), cart(-4, 3), cart(5, 1), cart(3, 2)};
  for (const Backend backend : backends()) {
    const auto together = make_simulation(backend, batch, few_iterations(), 2);
    together->advance(150);
    for (WorldIndex w = 0; w < 3; ++w)
      for (const int threads : {1, 7}) {
        const auto alone = make_simulation(backend, {batch[w]}, few_iterations(), threads);
        alone->advance(150);
        CHECK(same_bits(alone->bodies(0), together->bodies(w)));
        CHECK(alone->motor_torque(0, 1) == together->motor_torque(w, 1));
        CHECK(same_load(alone->joint_load(0, 0), together->joint_load(w, 0)));
        CHECK(same_load(alone->spring_load(0, 0), together->spring_load(w, 0)));
      }
    CHECK(same_bits(together->bodies(0), together->bodies(3)));
  }
}

TEST_CASE("a jointed world goes on from its snapshot, and takes another's place, with the same bits") {
  for (const Backend backend : backends()) {
    const auto through = make_simulation(backend, {cart(5, 3), cart(3, 2)}, few_iterations(), 1);
    through->advance(60);
    const Snapshot half = through->snapshot(1);
    through->advance(60);
    const auto resumed = make_simulation(backend, {cart(1, 2)}, few_iterations(), 1);
    resumed->restore(0, half);
    CHECK(length(resumed->joint_load(0, 0).force) == 0);
    resumed->advance(60);
    CHECK(same_bits(through->bodies(1), resumed->bodies(0)));
    // Fewer joints and bodies than the place holds.
    through->replace(0, cart(3, 2));
    const auto fresh = make_simulation(backend, {cart(3, 2)}, few_iterations(), 1);
    through->advance(60);
    fresh->advance(60);
    CHECK(same_bits(through->bodies(0), fresh->bodies(0)));
    CHECK(same_load(through->joint_load(0, 4), fresh->joint_load(0, 4)));
    CHECK(contains(input_error([&] { through->replace(1, cart(3, 3)); }), "the new world has"));
  }
}

TEST_CASE("bodies of one mechanism pass through each other, others do not") {
  SceneWorld w;
  w.origin = {-1, -1, -1};
  w.size = {2, 2, 2};
  w.gravity = {};
  const BodyIndex a = w.add_sphere({0, 0, 0}, 0.1f, 1000, 0), b = w.add_sphere({0.1, 0, 0}, 0.1f, 1000, 0);
  for (const Backend backend : backends()) {
    SceneWorld jointed = w;
    jointed.joint.push_back(revolute(jointed, b, a, {}, {0, 1, 0}));
    const auto together = simulate(backend, jointed, {}), apart = simulate(backend, w, {});
    together->advance(1);
    apart->advance(1);
    CHECK(together->report(0).contact_count == 0);
    CHECK(apart->report(0).contact_count == 1);
  }
}

TEST_CASE("joints across a periodic side hold the nearest images together") {
  for (const Backend backend : backends()) {
    SceneWorld w;
    w.size = {1, 1, 1};
    w.periodic_x = true;
    w.gravity = {};
    const BodyIndex a = w.add_sphere({0.9, 0.5, 0.5}, 0.04f, 1000, 0),
                    b = w.add_sphere({0.7, 0.5, 0.5}, 0.04f, 1000, 0);
    w.joint.push_back(revolute(w, a, b, {0.8, 0.5, 0.5}, {0, 0, 1}));
    w.body[a].velocity = w.body[b].velocity = {1, 0, 0};
    const auto simulation = simulate(backend, w, {});
    simulation->advance(200);  // a is past the side, b is not
    CHECK(simulation->body(0, a).position.x == Approx(0.1).margin(1e-5));
    CHECK(simulation->body(0, b).position.x == Approx(0.9).margin(1e-5));
    CHECK(simulation->body(0, a).velocity.x == Approx(1).epsilon(1e-5));
  }
}

TEST_CASE("arms longer than half a periodic side: a frame wider than its domain moves as in a wide one") {
  // Wheels 1.2 m apart on a bar of 0.8 m period: their hubs, folded, lie 0.4 m from each other.
  const auto bar = [](double period) {
    SceneWorld w;
    w.size = {10, period, 2};
    w.periodic_y = true;
    w.gravity = {};
    const BodyIndex frame = w.add_body({{5, 0.4, 1}, {}, {0, 1, 0}, {0.5, 0, 0.3}}, solid(20, {3, 1, 3}));
    for (const double side : {-1.0, 1.0}) {
      const Vec3d at{5, 0.4 + 0.6 * side, 1};
      const BodyIndex hub = w.add_body({at, {}, {0, 1, 0}, {}}, solid(5, {0.1, 0.2, 0.1}));
      w.joint.push_back(revolute(w, hub, frame, at, {0, 1, 0}));
      w.spring.push_back(spring_between(w, hub, frame, at + Vec3d{0.1, 0, 0}, at + Vec3d{0.1, 0, 0.3}, 500, 5));
    }
    return w;
  };
  for (const Backend backend : backends()) {
    const SceneWorld narrow = bar(0.8), wide = bar(8);
    const auto folded = simulate(backend, narrow, {}), open = simulate(backend, wide, {});
    for (int k = 0; k < 10; ++k) {
      folded->advance(100);
      open->advance(100);
      for (BodyIndex b = 0; b < 3; ++b) {
        const BodyState f = folded->body(0, b), o = open->body(0, b);
        CHECK(std::remainder(f.position.y - o.position.y, 0.8) == Approx(0).margin(1e-5));
        CHECK(f.position.x == Approx(o.position.x).margin(1e-5));
        CHECK(f.position.z == Approx(o.position.z).margin(1e-5));
        CHECK(length(f.velocity - o.velocity) < 1e-4f);
        CHECK(length(f.angular_velocity - o.angular_velocity) < 1e-4f);
      }
    }
    CHECK(folded->body(0, 1).position.y != Approx(open->body(0, 1).position.y).margin(0.1));
  }
}

TEST_CASE("joints, springs and motors that cannot work are refused with what is wrong") {
  SceneWorld w;
  w.size = {10, 10, 10};
  const BodyIndex ground = w.add_body({}, fixed_body()), wall = w.add_body({}, fixed_body());
  const BodyIndex a = w.add_body({{1, 1, 1}, {}, {}, {}}, solid(1, {1, 1, 1}));
  const BodyIndex b = w.add_body({{2, 1, 1}, {}, {}, {}}, solid(1, {1, 1, 1}));
  const auto message = [&](auto&& change) {
    SceneWorld bad = w;
    return input_error([&] {
      change(bad);
      make_simulation(Backend::cpu, {bad}, {}, 1);
    });
  };
  const auto with_joint = [&](const Joint& j) { return message([&](SceneWorld& s) { s.joint.push_back(j); }); };
  const auto with_spring = [&](const SpringDamper& p) {
    return message([&](SceneWorld& s) { s.spring.push_back(p); });
  };
  const auto with_motor = [&](const Motor& m) { return message([&](SceneWorld& s) { s.motor.push_back(m); }); };

  CHECK(with_joint(revolute(w, a, b, {1.5, 1, 1}, {0, 0, 1})).empty());
  CHECK(contains(with_joint(fixed(w, ground, wall, {})), "both fixed"));
  CHECK(contains(with_joint(fixed(w, a, a, {})), "to itself"));
  CHECK(contains(input_error([&] { fixed(w, a, 7, {}); }), "body 7"));
  CHECK(contains(input_error([&] { revolute(w, a, b, {}, {}); }), "no direction"));
  Joint j = revolute(w, a, b, {1.5, 1, 1}, {0, 0, 1});
  j.b.body = 9;
  CHECK(contains(with_joint(j), "joint 0: body 9"));
  j = revolute(w, a, b, {1.5, 1, 1}, {0, 0, 1});
  j.a.axis_B = {};
  CHECK(contains(with_joint(j), "length 0"));
  j = revolute(w, a, b, {1.5, 1, 1}, {0, 0, 1});
  j.a.point_B.x += 0.01f;
  CHECK(contains(with_joint(j), "disagree by 0.01 m"));
  j = revolute(w, a, b, {1.5, 1, 1}, {0, 0, 1});
  j.b.axis_B = {0, 0, -1};
  CHECK(contains(with_joint(j), "opposite"));
  CHECK(contains(with_joint(distance(w, a, b, {1, 1, 1}, {1, 1, 1})), "length is 0 m"));
  w.periodic_x = true;
  j = distance(w, a, b, {1, 1, 1}, {2, 1, 1});
  j.length = w.size.x;
  CHECK(contains(with_joint(j), "must be below half of that"));
  w.periodic_x = false;

  SpringDamper s = spring_between(w, a, b, {1, 1, 1}, {2, 1, 1}, 100, 1);
  CHECK(with_spring(s).empty());
  s.stiffness = -1;
  CHECK(contains(with_spring(s), "stiffness is -1"));
  s.stiffness = 1;
  s.table = force_table({{0, 1}, {1, 0}});
  CHECK(contains(with_spring(s), "never fall"));

  CHECK(with_motor(speed_motor(w, a, b, {1, 0, 0}, 1, 0)).empty());
  CHECK(contains(with_motor(speed_motor(w, a, b, {1, 0, 0}, 1, -2)), "largest torque is -2"));
  CHECK(contains(with_motor(speed_motor(w, ground, kWorld, {1, 0, 0}, 1, 2)), "neither of its bodies"));
  CHECK(contains(with_motor(speed_motor(w, a, a, {1, 0, 0}, 1, 2)), "against itself"));
}

TEST_CASE("a mechanism above the stated capacity is refused with its size") {
  SceneWorld w;
  w.size = {100, 100, 100};
  BodyIndex last = w.add_body({}, fixed_body());
  for (int k = 0; k <= kMaxMechanismBodies; ++k) {
    const BodyIndex next = w.add_body({{double(k), 0, 0}, {}, {}, {}}, solid(1, {1, 1, 1}));
    w.joint.push_back(spherical(w, next, last, {double(k), 0, 0}));
    last = next;
  }
  CHECK(contains(input_error([&] { make_simulation(Backend::cpu, {w}, {}, 1); }), "97 bodies and 291 equations"));
}
