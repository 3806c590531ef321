// Penalty contact in the engine: conservation, bits, checkpoints, motors.
#include "sim/io/checkpoint.h"
#include "tests/sim/penalty_scenes.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/same_bits.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr Index kSteps = 400;

/// Rough spheres on a cubic lattice that fly at each other and turn.
SceneWorld flying_spheres() {
  Draw draw(77);
  SceneWorld w = open_world({Real(0.5), Real(0.1)});
  w.gravity = {};
  for (int i = 0; i < 27; ++i) {
    const Vec3d at = grid_place(i, 3, 3) - Vec3d{1, 1, 1};
    const BodyIndex b = w.add_sphere(at * 0.022, 0.01f, 2600, 0);
    w.body[b].velocity = static_cast<Vec3>(at * -1.0 + draw.direction() * 0.3);
    w.body[b].angular_velocity = static_cast<Vec3>(draw.direction() * 30.0);
  }
  return w;
}

struct Momenta {
  Vec3d linear, angular;
};

Momenta momenta(const std::vector<BodyState>& bodies, double mass, double inertia) {
  Momenta sum;
  for (const BodyState& b : bodies) {
    const Vec3d v = static_cast<Vec3d>(b.velocity);
    sum.linear += v * mass;
    sum.angular += cross(b.position, v) * mass + static_cast<Vec3d>(b.angular_velocity) * inertia;
  }
  return sum;
}

}  // namespace

TEST_CASE("contacts conserve linear and angular momentum to round-off") {
  const SceneWorld w = flying_spheres();
  const double mass = 2600 * 4.0 / 3 * kPi * 1e-6, inertia = 0.4 * mass * 1e-4;
  for (const Backend backend : backends())
    for (const ContactLaw contact : kPenalties) {
      const auto simulation = simulate(backend, w, at_share(w, penalty_settings(contact, soft_law(0.7), 0), 0.5));
      const Momenta before = momenta(simulation->bodies(0), mass, inertia);
      double kinetic = 0;
      for (const Vec3& v : {w.body[0].velocity, w.body[26].velocity}) kinetic += dot(v, v);
      advance_for(*simulation, 0.02);
      const Momenta after = momenta(simulation->bodies(0), mass, inertia);
      const double scale = 27 * mass * std::sqrt(kinetic);
      CHECK(length(after.linear - before.linear) < 1e-5 * scale);
      CHECK(length(after.angular - before.angular) < 1e-5 * scale * 0.03);
      CHECK_FALSE(same_bits(w.body, simulation->bodies(0)));
    }
}

TEST_CASE("without damping and friction energy returns after every impact") {
  SceneWorld w = flying_spheres();
  w.set_law(0, 0, {});
  for (const ContactLaw contact : kPenalties) {
    const auto simulation = simulate(Backend::cpu, w, at_share(w, penalty_settings(contact, soft_law(1), 0), 0.2));
    simulation->advance(1);
    const double before = simulation->report(0).kinetic_energy;
    double least = before;
    for (int k = 0; k < 60; ++k) {
      advance_for(*simulation, 1e-3);
      least = std::min(least, simulation->report(0).kinetic_energy);
    }
    CHECK(least < 0.99 * before);  // they did meet
    CHECK(simulation->report(0).kinetic_energy == Approx(before).epsilon(5e-3));
  }
}

TEST_CASE("penalty contact has the same bits for one, two and seven threads") {
  for (const ContactLaw contact : kPenalties) {
    std::vector<BodyState> first;
    for (const int threads : {1, 2, 7}) {
      const auto simulation =
          make_simulation(Backend::cpu, {driven_penalty_wheel(601)}, wheel_settings(contact), threads);
      simulation->advance(kSteps);
      CHECK(simulation->report(0).flags == 0);
      CHECK(simulation->report(0).contact_count > 100);
      if (threads == 1) first = simulation->bodies(0);
      CHECK(same_bits(first, simulation->bodies(0)));
    }
  }
}

TEST_CASE("penalty contact has the same bits alone and in any place of a batch") {
  for (const Backend backend : backends())
    for (const ContactLaw contact : kPenalties) {
      const auto alone = simulate(backend, driven_penalty_wheel(602), wheel_settings(contact));
      alone->advance(kSteps);
      Scene batch{driven_penalty_wheel(700), driven_penalty_wheel(701), driven_penalty_wheel(602)};
      batch[1].motor[0].target = -20;
      batch[1].add_sphere({0.1, 0.1, 0.5}, 0.02f, 2600, 0);
      const auto together = make_simulation(backend, batch, wheel_settings(contact), 2);
      together->advance(kSteps);
      CHECK(same_bits(alone->bodies(0), together->bodies(2)));
      CHECK_FALSE(same_bits(alone->bodies(0), together->bodies(0)));
      CHECK(alone->motor_torque(0, 0) == together->motor_torque(2, 0));
      CHECK(alone->report(0).kinetic_energy == together->report(2).kinetic_energy);
    }
}

TEST_CASE("every backend takes the steps of the host") {
  const SceneWorld w = flying_spheres();
  for (const ContactLaw contact : kPenalties) {
    const StepSettings s = at_share(w, penalty_settings(contact, soft_law(0.7), 0), 0.5);
    const auto host = simulate(Backend::cpu, w, s);
    host->advance(1);
    const double before = host->report(0).kinetic_energy;
    advance_for(*host, 0.006);
    REQUIRE(host->report(0).kinetic_energy < 0.9 * before);  // they have met
    for (const Backend backend : backends()) {
      const auto simulation = simulate(backend, w, s);
      simulation->advance(1);
      advance_for(*simulation, 0.006);
      for (BodyIndex b = 0; b < 27; ++b)
        CHECK(length(simulation->body(0, b).position - host->body(0, b).position) < 1e-6);
    }
  }
}

TEST_CASE("penalty contact resumes from a checkpoint with the bits of an uninterrupted run") {
  const TemporaryFolder folder;
  for (const Backend backend : backends())
    for (const ContactLaw contact : kPenalties) {
      const SceneWorld w = driven_penalty_wheel(603);
      StepSettings s = wheel_settings(contact);
      s.sort_every = 150;  // bodies change places in memory, and histories with them
      const auto through = simulate(backend, w, s);
      through->advance(kSteps / 2);
      const Snapshot saved = through->snapshot(0);
      REQUIRE(saved.history.size() == saved.key.size());
      Index touching = 0;
      for (const ContactHistory& h : saved.history) touching += h.stiffness > 0 && length(h.force) > 0;
      CHECK(touching > 20);
      const std::string scene = scene_hash(w, s);
      save_checkpoint(folder.path() / "penalty.h5", saved, scene);
      through->advance(kSteps / 2);
      const auto resumed = simulate(backend, w, s);
      resumed->restore(0, load_checkpoint(folder.path() / "penalty.h5", scene));
      resumed->advance(kSteps / 2);
      CHECK(same_bits(through->bodies(0), resumed->bodies(0)));
      CHECK(through->motor_torque(0, 0) == resumed->motor_torque(0, 0));
      Snapshot forgetful = saved;
      for (ContactHistory& h : forgetful.history) h = {};
      resumed->restore(0, forgetful);
      resumed->advance(kSteps / 2);
      CHECK_FALSE(same_bits(through->bodies(0), resumed->bodies(0)));
      forgetful.history.clear();
      CHECK_THROWS_AS(resumed->restore(0, forgetful), InputError);
    }
}

TEST_CASE("other penalty laws make another scene of a checkpoint") {
  const SceneWorld w = driven_penalty_wheel(604);
  const StepSettings s = wheel_settings(ContactLaw::hertz);
  StepSettings other = s;
  other.penalty.restitution = 0.4f;
  CHECK(scene_hash(w, s) != scene_hash(w, other));
}

TEST_CASE("a motor turns its wheel up by torque over inertia and holds its speed") {
  for (const Backend backend : backends()) {
    SceneWorld w = open_world({});
    w.gravity = {};
    BodyMass rotor = solid(1, {1, 0.1f, 1});
    rotor.inverse_mass = {};
    const BodyIndex b = w.add_body({}, rotor);
    w.motor.push_back(speed_motor(w, b, kWorld, {0, 1, 0}, 2, 0.5));
    w.add_sphere({1, 0, 0}, 0.01f, 2600, 0);
    const auto simulation =
        simulate(backend, w, at_share(w, penalty_settings(ContactLaw::spring_damper, soft_law(0.5), 0), 0.9));
    advance_for(*simulation, 0.2);
    CHECK(simulation->body(0, b).angular_velocity.y == Approx(0.5 / 0.1 * 0.2).epsilon(2e-3));
    CHECK(simulation->motor_torque(0, 0) == Approx(0.5).epsilon(1e-4));
    advance_for(*simulation, 0.4);
    CHECK(simulation->body(0, b).angular_velocity.y == Approx(2).epsilon(1e-4));
    CHECK(std::fabs(simulation->motor_torque(0, 0)) < 1e-2);
  }
}
