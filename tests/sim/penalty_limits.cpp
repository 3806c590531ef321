// Limits of penalty contact: critical steps, overlaps, bad input.
#include <string>

#include "tests/sim/penalty_scenes.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

std::string refused(const SceneWorld& w, const StepSettings& s) {
  try {
    (void)make_simulation(Backend::cpu, {w}, s, 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a sphere between six others oscillates within its bounds just below the critical step") {
  for (const ContactLaw contact : kPenalties) {
    SceneWorld w = open_world({Real(10)});  // never slips
    w.gravity = {};
    const BodyIndex middle = w.add_sphere({}, 0.01f, 2600, 0);
    for (const Vec3d& side : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
      for (const double sign : {-1.0, 1.0}) {
        w.add_sphere(side * (sign * 0.0199), 0.01f, 2600, 0);
        w.mass.back() = fixed_body();
      }
    w.body[middle].velocity = {0.01f, 0.02f, 0.005f};
    w.body[middle].angular_velocity = {1, 0.5f, 2};
    const StepSettings s = at_share(w, penalty_settings(contact, soft_law(1), 0), 0.99);
    const auto simulation = simulate(Backend::cpu, w, s);
    simulation->advance(20000);
    const BodyState b = simulation->body(0, middle);
    CHECK(length(static_cast<Vec3d>(b.velocity)) < 0.1);
    CHECK(length(b.position) < 1e-4);
  }
}

TEST_CASE("the critical step of smooth spheres is that of twelve springs") {
  const SceneWorld w = meeting_pair(0.01, 2600, 1);
  const PenaltyLaw law = soft_law(1);
  const double mass = 2600 * 4.0 / 3 * kPi * 1e-6;
  const StepSettings s = penalty_settings(ContactLaw::spring_damper, law, 0);
  CHECK(critical_step(w, s).step == Approx(2 / std::sqrt(24 * double(law.stiffness) / mass)).epsilon(1e-5));
  StepSettings damped = s;
  damped.penalty.restitution = 0.3f;
  CHECK(critical_step(w, damped).step < critical_step(w, s).step);
  // A fifth of the Rayleigh time of quartz, as other programs take, and the step for overlaps of 1 % are alike.
  const ElasticMaterial quartz{70e9, 0.17};
  const double rayleigh = rayleigh_time(0.01, 2600, quartz.shear_modulus(), 0.17);
  const double step = critical_step(w, penalty_settings(ContactLaw::hertz, elastic_law(quartz, quartz, 1), 0)).step;
  CHECK(step / rayleigh > 0.15);
  CHECK(step / rayleigh < 0.5);
}

TEST_CASE("a step above the critical one and laws out of range get a sentence") {
  const SceneWorld w = meeting_pair(0.01, 2600, 1, 0.5);
  const StepSettings good = at_share(w, penalty_settings(ContactLaw::hertz, soft_law(0.5), 0), 0.9);
  CHECK(refused(w, good).empty());
  StepSettings s = good;
  s.step *= Real(1.2);
  CHECK(contains(refused(w, s), "allow at most"));
  s = good;
  s.penalty.modulus = -1e6f;
  CHECK(contains(refused(w, s), "modulus [Pa] of their penalty law is -1000000; it must be above zero"));
  s = good;
  s.penalty = {};
  CHECK(contains(refused(w, s), "must be above zero"));
  s.contact = ContactLaw::spring_damper;
  s.penalty.stiffness = -5;
  CHECK(contains(refused(w, s), "stiffness [N/m] of their penalty law is -5"));
  for (const double e : {0.0, -0.1, 1.5}) {
    s = good;
    s.penalty.restitution = Real(e);
    CHECK(contains(refused(w, s), "must be above 0 and at most 1"));
  }
  s = good;
  s.substeps = 2;
  CHECK(contains(refused(w, s), "penalty contact takes whole steps"));
  s.substeps = 1;
  s.give = 0.6f;
  CHECK(contains(refused(w, s), "penalty contact has springs of its own"));
  s = good;
  s.penalty.work_of_adhesion = 0.1f;
  s.penalty.adhesion = Adhesion::jkr;
  s.envelope = 1e-7f;
  CHECK(contains(refused(w, s), "make the envelope larger"));
  CHECK_THROWS_AS(elastic_law({-1, 0.3}, {1e9, 0.3}, 0.5), InputError);
  CHECK_THROWS_AS(elastic_law({1e9, 0.6}, {1e9, 0.3}, 0.5), InputError);
  CHECK_THROWS_AS(law_of_overlap(0, 1, 0.01, 2600, 0.5), InputError);
}

TEST_CASE("an impact overlaps by the share that its law was made for") {
  for (const ContactLaw contact : kPenalties) {
    const SceneWorld w = meeting_pair(0.01, 2600, 1);
    const StepSettings s = at_share(w, penalty_settings(contact, soft_law(1), 0), 0.2);
    const auto simulation = simulate(Backend::cpu, w, s);
    double overlap = 0;
    for (int k = 0; k < 0.004 / double(s.step); ++k) {
      simulation->advance(1);
      overlap = std::max(overlap, 0.02 - (simulation->body(0, 1).position.x - simulation->body(0, 0).position.x));
    }
    CHECK(overlap == Approx(0.05 * 0.01).epsilon(0.01));
  }
}
