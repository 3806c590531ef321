// Monitors and stop rules: each rule in a scene that triggers exactly it.
#include <cmath>
#include <cstring>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// 2 x 1 m, periodic along x and y, without gravity.
SceneWorld periodic_space() {
  SceneWorld w;
  w.gravity = {0, 0, 0};
  w.origin = {-1, 0, -10};
  w.size = {2, 1, 20};
  w.periodic_x = w.periodic_y = true;
  return w;
}

/// A body that flies at a constant velocity, watched.
SceneWorld flight(const Vec3& velocity, const Monitor& monitor) {
  SceneWorld w = periodic_space();
  w.add_body({{0.3, 0.4, 0}, {}, velocity, {}}, solid(2, {1, 1, 1}));
  w.monitor.push_back(monitor);
  return w;
}

Monitor watch(double time_limit) {
  Monitor m;
  m.time_limit = time_limit;
  return m;
}

/// Steps until the world stops; fails the test when it does not.
WorldStop run(Simulation& simulation, Index max = 5000) {
  for (Index n = 0; n < max; n += 7) {
    simulation.advance(7);
    if (simulation.stop(0).cause != StopCause::none) break;
  }
  REQUIRE(simulation.stop(0).cause != StopCause::none);
  return simulation.stop(0);
}

bool same_bits(const MonitorState& a, const MonitorState& b) {
  static_assert(sizeof(MonitorSample) == 6 * sizeof(double) + 4 * sizeof(Real) + 4 * sizeof(Index), "no padding");
  static_assert(sizeof(MonitorState) == sizeof(MonitorSample) + 7 * sizeof(double) + 2 * sizeof(Index), "no padding");
  return std::memcmp(&a, &b, sizeof a) == 0;
}

bool same_bits(const std::vector<MonitorSample>& a, const std::vector<MonitorSample>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(MonitorSample)) == 0;
}

std::vector<MonitorSample> all_samples(Simulation& s, WorldIndex w) {
  return s.samples(w, 0, 0, s.monitor(w, 0).sample_count);
}

/// A driven sphere that rolls and jumps over a periodic floor with bumps; everything that elements do, in one world.
SceneWorld rough_ride(std::uint64_t seed, double time_limit) {
  Draw draw(seed);
  SceneWorld w = periodic_space();
  w.gravity = {0, 0, Real(-kGravity)};
  w.set_law(0, 0, {Real(0.8), Real(0.02), 0});
  add_plane(w);
  for (int i = 0; i < 12; ++i) w.add_sphere({draw.between(-1, 1), draw.between(0, 1), 0.05}, Real(0.06), 2000, 0);
  const BodyIndex ball = w.add_sphere({0, 0.5, 0.35}, Real(0.3), 300, 0);
  w.motor.push_back(speed_motor(w, ball, kWorld, {0, 1, 0}, 0, 0));
  Controller c;
  c.type = ControllerType::velocity_by_torque;
  c.frame = ReferenceFrame::world;
  c.body = ball;
  c.command = {{0, 0}, {0.2, 1.5}};
  c.limit = {{0, 40}};
  c.proportional = 60;
  c.integral = 200;
  w.controller.push_back(c);
  w.force = {aerodynamic_drag(ball, 1.2, 1, 0.3), tow_load(ball, ReferenceFrame::world, {1, 0.2f, 0}, 10)};
  Monitor m = watch(time_limit);
  m.body = ball;
  m.motor = 0;
  m.height = 0.3;
  m.start = 0.05;
  m.stride = 3;
  w.monitor.push_back(m);
  return w;
}

StepSettings few_iterations() {
  StepSettings s;
  s.iterations = 20;
  return s;
}

}  // namespace

TEST_CASE("distance is counted through periodic sides, forwards and backwards") {
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, flight({Real(3.7), Real(-2.3), Real(0.5)}, watch(100)), {});
    simulation->advance(4000);
    const MonitorState m = simulation->monitor(0, 0);
    INFO(name_of(backend));
    CHECK(m.now.x == Approx(3.7 * 4).epsilon(1e-6));  // seven periods
    CHECK(m.now.y == Approx(-2.3 * 4).epsilon(1e-6));
    CHECK(m.now.drop == Approx(-0.5 * 4).epsilon(1e-6));
    CHECK(m.now.drop_sum == Approx(-0.5 * 1e-3 * 4000 * 4001 / 2).epsilon(1e-6));
    CHECK(m.now.speed == Real(3.7));
    CHECK(m.now.step == 4000);
    CHECK(std::abs(simulation->body(0, 0).position.x) <= 1);
  }
}

TEST_CASE("a motor's angle, torque and work are summed; its work appears as energy and nothing is gained") {
  const double inertia = 0.5, torque = 2, h = 1e-3;
  for (const Backend backend : backends()) {
    SceneWorld w = periodic_space();
    w.add_body({}, solid(1, {Real(inertia), Real(inertia), Real(inertia)}));
    w.motor.push_back(speed_motor(w, 0, kWorld, {0, 1, 0}, 1000, torque));
    Monitor m = watch(100);
    m.motor = 0;
    w.monitor.push_back(m);
    const auto simulation = simulate(backend, w, {});
    const int n = 600;
    simulation->advance(n);
    const MonitorState s = simulation->monitor(0, 0);
    const double ramp = torque / inertia * h, sum = 0.5 * n * (n + 1);
    INFO(name_of(backend));
    CHECK(s.now.turned == Approx(ramp * h * sum).epsilon(1e-5));
    CHECK(s.now.torque == Approx(torque).epsilon(1e-5));
    CHECK(s.now.torque_sum == Approx(torque * n).epsilon(1e-5));
    CHECK(s.now.work == Approx(torque * ramp * h * sum).epsilon(1e-5));
    CHECK(s.exchanged == Approx(s.now.work));
    CHECK(s.energy == Approx(0.5 * inertia * ramp * n * ramp * n).epsilon(1e-4));
    CHECK(s.energy_gained < 1e-6 * s.energy);
    // Means over the second half: torque T; angle and work by differences of the same sums.
    const MonitorMeans half = means_between(simulation->samples(0, 0, n / 2 - 1, 1).front(), s.now, h);
    CHECK(half.time == Approx(0.3));
    CHECK(half.torque == Approx(torque).epsilon(1e-5));
    CHECK(half.work == Approx(torque * half.turned).epsilon(1e-5));
    CHECK(half.turned == Approx(ramp * h * (sum - 0.5 * 300 * 301)).epsilon(1e-5));
  }
}

TEST_CASE("energy that nobody supplied is counted; what forces, gravity and springs give is not") {
  for (const Backend backend : backends()) {
    SceneWorld w = periodic_space();
    w.gravity = {1, 0, 0};
    w.add_body({{0, 0, 1}, {}, {}, {}}, solid(2, {1, 1, 1}));
    w.add_body({{0, 0.5, 0}, {}, {}, {}}, fixed_body());
    w.spring.push_back(spring_along(w, 0, 1, {0, 0, 1}, {0, 0.5, 0}, {0, 0, 1}, 500, 0));
    w.spring[0].free_length = 0.9;
    ForceElement push;
    push.force = {0, 3, 0};
    w.force.push_back(push);
    w.monitor.push_back(watch(100));
    const auto simulation = simulate(backend, w, {});
    simulation->advance(400);
    const MonitorState before = simulation->monitor(0, 0);
    INFO(name_of(backend));
    CHECK(before.energy > 0.4);
    CHECK(before.energy_gained < 1e-4);
    CHECK(simulation->report(0).spring_energy > 0);
    BodyState kicked = simulation->body(0, 0);
    const double old = kicked.velocity.x;
    kicked.velocity.x += 4;
    simulation->set_body(0, 0, kicked);
    simulation->advance(1);
    const double kick = (old + 4) * (old + 4) - old * old;  // m / 2 = 1
    CHECK(simulation->monitor(0, 0).energy_gained == Approx(kick).epsilon(1e-3));
  }
}

TEST_CASE("energy that gravity gives and a force takes away went through the world twice") {
  for (const Backend backend : backends()) {
    SceneWorld w = flight({1, 0, 0}, watch(100));
    w.gravity = {1, 0, 0};
    ForceElement drag;
    drag.force = {Real(-1.5), 0, 0};
    w.force.push_back(drag);
    const auto simulation = simulate(backend, w, {});
    simulation->advance(500);
    const MonitorState m = simulation->monitor(0, 0);
    INFO(name_of(backend));
    CHECK(m.energy - 1 == Approx((2 - 1.5) * m.now.x).epsilon(1e-3));  // what is left of 2 kg that started at 1 m/s
    CHECK(m.exchanged == Approx((2 + 1.5) * m.now.x).epsilon(1e-3));
  }
}

TEST_CASE("a world stops when its body has covered the distance, but not too early") {
  for (const Backend backend : backends()) {
    Monitor m = watch(10);
    m.distance = 0.5005;
    const auto prompt = simulate(backend, flight({1, 0, 0}, m), {});
    INFO(name_of(backend));
    WorldStop stop = run(*prompt);
    CHECK(stop.cause == StopCause::distance);
    CHECK(stop.step == 501);
    m.start = 0.2;
    m.earliest = 0.7;
    const auto patient = simulate(backend, flight({1, 0, 0}, m), {});
    stop = run(*patient);
    CHECK(stop.cause == StopCause::distance);
    CHECK(stop.step == 900);
    CHECK(patient->monitor(0, 0).now.x == Approx(0.9).epsilon(1e-6));
    m.time_limit = 0.6;  // the time limit ends the waiting, and the distance is the cause
    const auto late = simulate(backend, flight({1, 0, 0}, m), {});
    stop = run(*late);
    CHECK(stop.cause == StopCause::distance);
    CHECK(stop.step == 800);
  }
}

TEST_CASE("a world stops at its time limit after the start") {
  for (const Backend backend : backends()) {
    Monitor m = watch(0.6);
    m.start = 0.25;
    const auto simulation = simulate(backend, flight({1, 0, 0}, m), {});
    const WorldStop stop = run(*simulation);
    INFO(name_of(backend));
    CHECK(stop.cause == StopCause::time_limit);
    CHECK(stop.step == 850);
    CHECK(simulation->monitor(0, 0).sample_count == 850);
  }
}

TEST_CASE("a world stops when its body has not moved on over a whole window") {
  Monitor m = watch(10);
  m.start = 0.1;
  m.immobile_from = 0.2;
  m.immobile_window = 0.3;
  m.immobile_speed = 0.05;
  for (const Backend backend : backends()) {
    INFO(name_of(backend));
    const auto slow = simulate(backend, flight({Real(0.049), 0, 0}, m), {});
    WorldStop stop = run(*slow);
    CHECK(stop.cause == StopCause::immobile);
    CHECK(stop.step == 600);  // the end of the first window
    const auto fast = simulate(backend, flight({Real(0.051), 0, 0}, m), {});
    CHECK(run(*fast, 20000).cause == StopCause::time_limit);
    // One that slows down: v = 1 - 0.8 t. x(t) - x(t - 0.3) = 0.3 (v + 0.12) < 0.015 from v < -0.07 on, t > 1.3375 s.
    SceneWorld braking = flight({1, 0, 0}, m);
    braking.gravity.x = Real(-0.8);
    for (const Index stride : {1, 10}) {
      braking.monitor[0].stride = stride;
      const auto simulation = simulate(backend, braking, {});
      stop = run(*simulation);
      CHECK(stop.cause == StopCause::immobile);
      CHECK(stop.step >= 1337);
      CHECK(stop.step <= 1338 + stride);
      CHECK(stop.step % stride == 0);
    }
  }
}

TEST_CASE("a world stops when its body has slid back, but not before the start") {
  Monitor m = watch(10);
  m.slid_back = 0.3005;
  for (const Backend backend : backends()) {
    INFO(name_of(backend));
    const auto simulation = simulate(backend, flight({-1, 0, 0}, m), {});
    WorldStop stop = run(*simulation);
    CHECK(stop.cause == StopCause::slid_back);
    CHECK(stop.step == 301);
    m.start = 0.4;
    const auto parked = simulate(backend, flight({-1, 0, 0}, m), {});
    stop = run(*parked);
    CHECK(stop.cause == StopCause::slid_back);
    CHECK(stop.step == 400);
    m.start = 0;
  }
}

TEST_CASE("a world stops when a flag is raised in it") {
  for (const Backend backend : backends()) {
    SceneWorld w = flight({0, 0, -5}, watch(100));  // out of the domain, 10 m below, after 2 s
    const auto simulation = simulate(backend, w, {});
    const WorldStop stop = run(*simulation);
    INFO(name_of(backend));
    CHECK(stop.cause == StopCause::flags);
    CHECK(std::abs(stop.step - 2000) <= 1);
    CHECK(simulation->monitor(0, 0).now.flags == flag_left_domain);
  }
}

TEST_CASE("the monitors of a stopped world rest while it and the others go on") {
  Monitor quick = watch(0.1), patient = watch(0.5);
  for (const Backend backend : backends()) {
    SceneWorld first = flight({1, 0, 0}, patient);
    first.monitor.push_back(quick);
    const auto simulation = make_simulation(backend, {first, flight({2, 0, 0}, patient)}, {}, 1);
    simulation->advance(100);
    INFO(name_of(backend));
    const WorldStop stop = simulation->stop(0);
    CHECK(stop.cause == StopCause::time_limit);
    CHECK(stop.monitor == 1);
    CHECK(stop.step == 100);
    const MonitorState both[2] = {simulation->monitor(0, 0), simulation->monitor(0, 1)};
    simulation->advance(700);
    for (const Index i : {0, 1}) CHECK(same_bits(simulation->monitor(0, i), both[i]));
    CHECK(simulation->stop(0).step == 100);
    CHECK(simulation->stops()[1].cause == StopCause::time_limit);
    CHECK(simulation->stops()[1].step == 500);
    CHECK(simulation->monitor(1, 0).now.x == Approx(1).epsilon(1e-6));
    CHECK(simulation->body(0, 0).position.x == Approx(0.3 + 0.8 - 2).margin(1e-5));  // it flew on
  }
}

TEST_CASE("a record has the same bits for one step at a time, many at once, and a world in company") {
  const Index steps = 400;
  for (const Backend backend : backends()) {
    const auto many = simulate(backend, rough_ride(81, 0.32), few_iterations());
    many->advance(steps);
    const MonitorState expected = many->monitor(0, 0);
    INFO(name_of(backend));
    CHECK(many->report(0).flags == 0);
    CHECK(many->stop(0).cause == StopCause::time_limit);
    CHECK(many->stop(0).step == 370);
    CHECK(expected.sample_count == 123);
    CHECK(expected.now.x > 0.05);
    CHECK(expected.now.contact_count > 0);

    const auto single = simulate(backend, rough_ride(81, 0.32), few_iterations());
    for (Index i = 0; i < steps; ++i) single->advance(1);
    CHECK(same_bits(single->monitor(0, 0), expected));
    CHECK(same_bits(all_samples(*single, 0), all_samples(*many, 0)));

    Scene company;
    for (int i = 0; i < 5; ++i) company.push_back(rough_ride(i == 3 ? 81 : 90 + i, i == 3 ? 0.32 : 0.1 * (i + 1)));
    const auto batch = make_simulation(backend, company, few_iterations(), 2);
    batch->advance(steps);
    CHECK(same_bits(batch->monitor(3, 0), expected));
    CHECK(same_bits(all_samples(*batch, 3), all_samples(*many, 0)));
    CHECK_FALSE(same_bits(batch->monitor(2, 0), expected));
  }
}

TEST_CASE("controllers and monitors go on with the same bits from a snapshot, also in another place of a batch") {
  for (const Backend backend : backends()) {
    const SceneWorld w = rough_ride(82, 0.5);
    const auto through = simulate(backend, w, few_iterations());
    through->advance(200);
    const Snapshot saved = through->snapshot(0);
    through->advance(400);
    const auto resumed = make_simulation(backend, {rough_ride(83, 0.2), w}, few_iterations(), 1);
    resumed->advance(37);
    resumed->restore(1, saved);
    resumed->advance(400);
    INFO(name_of(backend));
    CHECK(resumed->stop(0).step == 250);
    CHECK(resumed->stop(1).step == 550);
    CHECK(same_bits(resumed->monitor(1, 0), through->monitor(0, 0)));
    CHECK(same_bits(all_samples(*resumed, 1), all_samples(*through, 0)));
    refused([&] { resumed->restore(0, saved); }, "samples of monitors");
  }
}

TEST_CASE("a world that takes the place of a stopped one is watched, driven and pushed as if it were alone") {
  for (const Backend backend : backends()) {
    const SceneWorld next = rough_ride(84, 0.15);
    const auto alone = simulate(backend, next, few_iterations());
    alone->advance(250);
    SceneWorld first = rough_ride(85, 0.3);
    first.force.push_back(tow_load(first.force[0].body, ReferenceFrame::body, {0, 0, 1}, 3));
    first.monitor.push_back(first.monitor[0]);
    const auto batch = make_simulation(backend, {rough_ride(86, 0.9), first, rough_ride(87, 0.9)}, few_iterations(), 1);
    batch->advance(350);
    INFO(name_of(backend));
    CHECK(batch->stop(1).cause == StopCause::time_limit);
    batch->replace(1, next);
    CHECK(batch->stop(1).cause == StopCause::none);
    CHECK(batch->monitor(1, 0).sample_count == 0);
    batch->advance(250);
    CHECK(batch->stop(1).step == 200);
    CHECK(same_bits(batch->monitor(1, 0), alone->monitor(0, 0)));
    CHECK(same_bits(all_samples(*batch, 1), all_samples(*alone, 0)));
    refused([&] { (void)batch->monitor(1, 1); }, "no monitor 1");
    // One without elements: nothing of the old world pushes its body or sets its motor.
    SceneWorld bare = periodic_space();
    bare.add_body({{0, 0.5, 0}, {}, {1, 0, 0}, {}}, solid(1, {1, 1, 1}));
    bare.motor.push_back(speed_motor(bare, 0, kWorld, {0, 1, 0}, 2, 1000));
    batch->replace(1, bare);
    batch->advance(50);
    CHECK(batch->body(1, 0).velocity.x == 1);
    CHECK(batch->report(1).force_power == 0);
    CHECK(batch->body(1, 0).angular_velocity.y == Approx(2).epsilon(1e-5));
    CHECK(batch->monitor(0, 0).now.step == 650);
    SceneWorld longer = next;
    longer.monitor[0].time_limit = 5;
    refused([&] { batch->replace(1, longer); }, "samples of monitors");
  }
}

TEST_CASE("a monitor of nothing, without an end or asked for more than it has is refused by name") {
  const auto with = [](auto&& change) {
    SceneWorld w = flight({1, 0, 0}, watch(1));
    change(w.monitor[0]);
    return [w] { simulate(Backend::cpu, w, {}); };
  };
  refused(with([](Monitor& m) { m.body = 3; }), "world 0: monitor 0 watches body 3");
  refused(with([](Monitor& m) { m.motor = 0; }), "watches motor 0");
  refused(with([](Monitor& m) { m.stride = 0; }), "stride of 0");
  refused(with([](Monitor& m) { m.time_limit = 0; }), "time limit");
  refused(with([](Monitor& m) { m.time_limit = 1e8; }), "steps");
  refused(with([](Monitor& m) { m.earliest = -1; }), "below zero");
  refused(with([](Monitor& m) { m.slid_back = NAN; }), "not a number");
  const auto simulation = simulate(Backend::cpu, flight({1, 0, 0}, watch(1)), {});
  simulation->advance(10);
  refused([&] { simulation->samples(0, 0, 5, 6); }, "recorded 10");
  refused([&] { simulation->monitor(0, 1); }, "no monitor 1");
}
