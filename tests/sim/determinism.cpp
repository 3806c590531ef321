#include <cmath>

#include "sim/scene/scene.h"
#include "tests/sim/driven_wheel.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

StepSettings few_iterations(Iteration iteration = Iteration::apgd) {
  StepSettings s;
  s.iterations = 10;
  s.iteration = iteration;
  return s;
}

constexpr Index kSteps = 30, kHalf = kSteps / 2;
constexpr Iteration kEverySolver[] = {Iteration::apgd, Iteration::jacobi, Iteration::gauss_seidel, Iteration::bb,
                                      Iteration::jacobi_scan};

}  // namespace

TEST_CASE("one, two and seven threads give the same bits") {
  const SceneWorld w = driven_wheel(601);
  for (const Iteration iteration : kEverySolver) {
    std::vector<BodyState> first;
    for (const int threads : {1, 2, 7}) {
      const auto simulation = make_simulation(Backend::cpu, {w}, few_iterations(iteration), threads);
      simulation->advance(kSteps);
      CHECK(simulation->report(0).contact_count > 1000);
      CHECK(simulation->report(0).flags == 0);
      if (threads == 1) first = simulation->bodies(0);
      INFO(threads << " threads, solver " << name_of(iteration));
      CHECK(same_bits(first, simulation->bodies(0)));
    }
  }
}

TEST_CASE("a world has the same bits alone and in any place of a batch") {
  for (const Backend backend : backends())
    for (const Iteration iteration : kEverySolver) {
      const auto alone = simulate(backend, driven_wheel(602), few_iterations(iteration));
      alone->advance(kSteps);
      Scene batch;
      for (int i = 0; i < 6; ++i) batch.push_back(driven_wheel(i == 3 ? 602 : 700 + i));
      batch[1].motor[0].target = -20;
      batch[2].gravity.x = 5;
      const auto together = make_simulation(backend, batch, few_iterations(iteration), 2);
      together->advance(kSteps);
      INFO(name_of(backend) << ", solver " << name_of(iteration));
      CHECK(same_bits(alone->bodies(0), together->bodies(3)));
      CHECK_FALSE(same_bits(alone->bodies(0), together->bodies(4)));
      CHECK(alone->motor_torque(0, 0) == together->motor_torque(3, 0));
      CHECK(alone->report(0).rms_residual == together->report(3).rms_residual);
    }
}

TEST_CASE("reports and contact forces of a batch are those of each world, and forces are the sums over contacts") {
  for (const Backend backend : backends()) {
    const auto batch = make_simulation(backend, {driven_wheel(1), driven_wheel(2)}, few_iterations(), 1);
    const BodyIndex ground = 0, wheel = 16 * 8 * 6 + 1;
    const std::vector<WorldBody> bodies{{1, wheel}, {0, wheel}, {0, ground}, {1, 5}};
    for (const Vec3d& before : batch->contact_forces(bodies)) CHECK(dot(before, before) == 0);
    batch->advance(kSteps);
    const std::vector<StepReport> reports = batch->reports();
    REQUIRE(reports.size() == 2);
    for (const WorldIndex w : {0, 1}) {
      CHECK(reports[std::size_t(w)].rms_residual == batch->report(w).rms_residual);
      CHECK(reports[std::size_t(w)].kinetic_energy == batch->report(w).kinetic_energy);
      CHECK(reports[std::size_t(w)].contact_count == batch->report(w).contact_count);
    }
    const std::vector<Vec3d> forces = batch->contact_forces(bodies);
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const auto contacts = batch->contacts(bodies[k].world);
      const auto impulses = batch->impulses(bodies[k].world);
      Vec3d sum;
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (contacts[i].body_a == bodies[k].body) sum += static_cast<Vec3d>(impulses[i].linear);
        if (contacts[i].body_b == bodies[k].body) sum -= static_cast<Vec3d>(impulses[i].linear);
      }
      const Vec3d off = forces[k] - sum * (1.0 / batch->settings().substep());
      CHECK(std::sqrt(dot(off, off)) <= 1e-9 * (1 + std::sqrt(dot(forces[k], forces[k]))));
    }
    CHECK(forces[0].z > 0);  // the ground carries the wheel
  }
}

TEST_CASE("Gauss-Seidel and spectral gradients leave less residual than plain gradients") {
  for (const Backend backend : backends()) {
    const auto residual = [&](Iteration iteration) {
      StepSettings settings = few_iterations(iteration);
      settings.iterations = 40;
      const auto simulation = simulate(backend, driven_wheel(605), settings);
      double sum = 0;
      for (Index i = 0; i < kSteps; ++i) {
        simulation->advance(1);
        sum += simulation->report(0).rms_residual;
      }
      return sum / kSteps;
    };
    const double plain = residual(Iteration::jacobi), swept = residual(Iteration::gauss_seidel),
                 spectral = residual(Iteration::bb), accelerated = residual(Iteration::apgd);
    WARN(name_of(backend) << ", mean residual after 40 iterations [m/s]: jacobi " << plain << ", gauss_seidel " << swept
                          << ", bb " << spectral << ", apgd " << accelerated);
    CHECK(swept < 0.7 * plain);
    CHECK(spectral < 0.7 * plain);
    CHECK(accelerated < 0.7 * plain);
  }
}

TEST_CASE("a restored simulation goes on with the bits of an uninterrupted one") {
  for (const Backend backend : backends()) {
    const SceneWorld w = driven_wheel(603);
    const auto through = simulate(backend, w, few_iterations());
    through->advance(kHalf);
    // What the driver of a trial changes between steps belongs to the state too.
    through->set_gravity(0, {1, 0, -9});
    through->set_motor(0, 0, 6, 50);
    through->set_law(0, 0, 1, {Real(0.3), Real(0.05), 0});
    const Snapshot saved = through->snapshot(0);
    through->advance(kHalf);

    const auto resumed = simulate(backend, w, few_iterations());
    resumed->restore(0, saved);
    CHECK(resumed->report(0).time == Approx(kHalf * double(few_iterations().step)));
    resumed->advance(kHalf);
    INFO(name_of(backend));
    CHECK(same_bits(through->bodies(0), resumed->bodies(0)));
    CHECK(through->motor_torque(0, 0) == resumed->motor_torque(0, 0));
    CHECK(through->report(0).time == resumed->report(0).time);

    // Back in time in the same simulation, which holds more contacts than the snapshot by now.
    through->restore(0, saved);
    CHECK(length(through->contact_force(0, 0)) == 0);  // no step taken since
    through->advance(kHalf);
    CHECK(same_bits(through->bodies(0), resumed->bodies(0)));
  }
}

TEST_CASE("a snapshot of another scene is refused") {
  const auto one = simulate(Backend::cpu, driven_wheel(604), few_iterations());
  SceneWorld other;
  other.add_sphere({}, 0.1f, 1000, 0);
  const auto two = simulate(Backend::cpu, other, few_iterations());
  CHECK_THROWS_AS(two->restore(0, one->snapshot(0)), InputError);
}
