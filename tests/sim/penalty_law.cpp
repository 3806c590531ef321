// Laws of penalty contact against closed forms.
#include "sim/law/penalty_force.h"

#include "tests/sim/penalty_scenes.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr double kRadius = 0.01, kDensity = 2600;

/// A pair of equal spheres under the law `hertz`, seen by penalty_force.
struct Pair {
  PenaltyNumbers numbers;
  PenaltyContact contact;
  ContactHistory history;

  explicit Pair(const PenaltyLaw& law) : numbers{law, Real(damping_ratio_of(double(law.restitution)))} {
    contact.normal = {0, 0, 1};
    contact.mass = 0.01f;
    contact.radius = Real(kRadius / 2);
  }
  PenaltyForce step(double h) { return penalty_force<HertzLaw>(contact, numbers, Real(h), history); }
};

PenaltyLaw steel_like(double ratio, double restitution = 1) {
  return elastic_law({1e8, ratio}, {1e8, ratio}, restitution);
}

/// Lowest force along the normal while a pair is drawn apart slowly, as a share of pi w R*.
double pull_off(Adhesion adhesion) {
  PenaltyLaw law = steel_like(0.3);
  law.work_of_adhesion = 0.2f;
  law.adhesion = adhesion;
  Pair p(law);
  double lowest = 0;
  for (int k = 0; k <= 4000; ++k) {
    p.contact.gap = Real(-2e-6 + 1e-9 * k);
    lowest = std::min(lowest, double(p.step(1e-5).force.z));
  }
  CHECK(p.history.stiffness == 0);  // parted in the end
  return -lowest / (kPi * 0.2 * kRadius / 2);
}

}  // namespace

TEST_CASE("an impact returns the restitution of its law within 1 %") {
  for (const Backend backend : backends())
    for (const ContactLaw contact : kPenalties)
      for (const double e : {0.1, 0.5, 0.8, 1.0}) {
        const SceneWorld w = meeting_pair(kRadius, kDensity, 1);
        const StepSettings s = at_share(w, penalty_settings(contact, soft_law(e), 0), 0.02);
        const auto simulation = simulate(backend, w, s);
        advance_for(*simulation, 0.01);
        const double apart = simulation->body(0, 1).velocity.x - simulation->body(0, 0).velocity.x;
        CHECK(agrees(std::string("restitution, law ") + std::to_string(int(contact)) + ", " + name_of(backend), e,
                     apart, 0.01 * e));
      }
}

TEST_CASE("the restitution of a damping ratio is that of the integrated oscillator") {
  for (const double z : {0.05, 0.3, 0.7, 1.0, 1.8}) {
    double x = 0, v = 1;
    const double h = 1e-5;
    while (x + 2 * z * v > 0 || x == 0) {  // until the force is zero; Runge's midpoint rule
      const double mx = x + h / 2 * v, mv = v - h / 2 * (x + 2 * z * v);
      v -= h * (mx + 2 * z * mv);
      x += h * mv;
    }
    CHECK(restitution_of(z) == Approx(-v).epsilon(1e-4));
    CHECK(damping_ratio_of(restitution_of(z)) == Approx(z).epsilon(1e-9));
  }
}

TEST_CASE("an elastic impact has Hertz's overlap, force and duration") {
  // Chung & Ooi (2011), test 1, glass and limestone: 20 mm spheres meet at 20 m/s.
  struct Case {
    const char* name;
    double modulus, ratio, density, overlap, force, duration;
  };
  for (const Case& c : {Case{"glass", 48e9, 0.2, 2800, 274.11e-6, 10.697e3, 40.34e-6},
                        Case{"limestone", 20e9, 0.25, 2500, 368.30e-6, 7.108e3, 54.20e-6}})
    for (const Backend backend : backends()) {
      const ElasticMaterial m{c.modulus, c.ratio};
      SceneWorld w = meeting_pair(0.01, c.density, 20);
      StepSettings s = penalty_settings(ContactLaw::hertz, elastic_law(m, m, 1), 0);
      s = at_share(w, s, 0.1);
      const auto simulation = simulate(backend, w, s);
      double overlap = 0, force = 0;
      int touching = 0;
      for (int k = 0; k < 4000 && (touching == 0 || overlap == 0 || force > 0); ++k) {
        simulation->advance(1);
        const double pushed = std::fabs(simulation->contact_force(0, 0).x);
        const double gap = simulation->body(0, 1).position.x - simulation->body(0, 0).position.x - 0.02;
        overlap = std::max(overlap, -gap);
        force = std::max(force, pushed);
        touching += pushed > 0;
        if (touching > 0 && pushed == 0) break;
      }
      const std::string label = std::string(c.name) + ", " + name_of(backend);
      CHECK(agrees("Hertz, overlap [m], " + label, c.overlap, overlap, 2e-3 * c.overlap));
      CHECK(agrees("Hertz, force [N], " + label, c.force, force, 2e-3 * c.force));
      CHECK(agrees("Hertz, duration [s], " + label, c.duration, touching * double(s.step), 0.01 * c.duration));
      // The closed form again: 2.94 overlap / v (Johnson 1985, section 11.4).
      CHECK(2.9432 * c.overlap / 20 == Approx(c.duration).epsilon(2e-3));
    }
}

TEST_CASE("tangential over normal stiffness is Mindlin's 2 (1 - nu) / (2 - nu), and slip begins at mu F") {
  for (const double ratio : {0.0, 0.25, 0.45}) {
    Pair p(steel_like(ratio));
    p.contact.mu = 0.4f;
    const double overlap = 1e-4, h = 1e-6;
    p.contact.gap = Real(-overlap);
    const double normal = p.step(h).force.z;
    p.contact.gap = Real(-1.001 * overlap);
    const double stiffness = (p.step(h).force.z - normal) / (1e-3 * overlap);
    p.contact.gap = Real(-overlap);
    p.history = {};
    p.contact.velocity = {1e-2f, 0, 0};
    double slid = 0, force = 0, before = 0;
    do {
      before = force;
      force = -p.step(h).force.x;
      slid += 1e-2 * h;
    } while (force > before && slid < overlap);
    CHECK(force == Approx(0.4 * normal).epsilon(1e-4));
    Pair q(steel_like(ratio));
    q.contact = p.contact;
    const double tangential = -q.step(h).force.x / (1e-2 * h);
    CHECK(tangential / stiffness == Approx(2 * (1 - ratio) / (2 - ratio)).epsilon(2e-3));
  }
}

TEST_CASE("a sliding sphere ends rolling at 5/7 of its speed after 2 v0 / (7 mu g)") {
  const double speed = 0.5, mu = 0.3, expected = 2 * speed / (7 * mu * kGravity);
  for (const Backend backend : backends())
    for (const ContactLaw contact : kPenalties) {
      SceneWorld w = open_world({Real(mu)});
      add_plane(w);
      w.add_sphere({0, 0, kRadius}, Real(kRadius), Real(kDensity), 0);
      w.body[1].velocity.x = Real(speed);
      const StepSettings s = at_share(w, penalty_settings(contact, soft_law(0.5), 0), 0.5);
      const auto simulation = simulate(backend, w, s);
      double rolling_since = 0;
      for (double time = 0; time < 1.5 * expected; time = simulation->report(0).time) {
        simulation->advance(10);
        const BodyState b = simulation->body(0, 1);
        if (b.velocity.x - b.angular_velocity.y * kRadius > 5e-3 * speed) rolling_since = simulation->report(0).time;
      }
      const BodyState b = simulation->body(0, 1);
      CHECK(agrees("penalty, final speed [m/s]", speed * 5 / 7, b.velocity.x, 2e-3 * speed));
      CHECK(agrees("penalty, spin times radius [m/s]", speed * 5 / 7, b.angular_velocity.y * kRadius, 3e-3 * speed));
      CHECK(agrees("penalty, time of rolling [s]", expected, rolling_since, 0.02 * expected));
    }
}

TEST_CASE("rolling resistance slows a rolling sphere by 5/7 mu_r g") {
  const double rolling = 0.05, speed = 0.5, seconds = 0.4;
  for (const ContactLaw contact : kPenalties) {
    SceneWorld w = open_world({Real(0.8), Real(rolling)});
    add_plane(w);
    w.add_sphere({0, 0, kRadius}, Real(kRadius), Real(kDensity), 0);
    w.body[1].velocity.x = Real(speed);
    w.body[1].angular_velocity.y = Real(speed / kRadius);
    const auto simulation = simulate(Backend::cpu, w, at_share(w, penalty_settings(contact, soft_law(0.5), 0), 0.5));
    advance_for(*simulation, seconds);
    CHECK(agrees("penalty, rolling decay, speed [m/s]", speed - 5.0 / 7 * rolling * kGravity * seconds,
                 simulation->body(0, 1).velocity.x, 0.01 * speed));
  }
}

TEST_CASE("a rigid rotation turns the remembered force with the pair and keeps its length") {
  Pair p(steel_like(0.3));
  p.contact.mu = 10;
  p.contact.rho = p.contact.sigma = 10;
  p.contact.gap = -1e-4f;
  p.contact.velocity = {0.3f, -0.2f, 0};
  p.contact.turn = {1, 2, 3};
  const double h = 1e-5;
  for (int k = 0; k < 5; ++k) (void)p.step(h);
  const Vec3d force = static_cast<Vec3d>(p.history.force), moment = static_cast<Vec3d>(p.history.moment);
  REQUIRE(length(force) > 0);
  p.contact.velocity = p.contact.turn = {};
  const Vec3d spin{3, -5, 11};  // of both bodies [rad/s]
  const double speed = length(spin);
  const int steps = 50000;
  const auto turned_by = [&](const Vec3d& v, double angle) {  // Rodrigues
    const Vec3d axis = spin * (1 / speed);
    return v * std::cos(angle) + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * (1 - std::cos(angle)));
  };
  for (int k = 1; k <= steps; ++k) {
    p.contact.normal = static_cast<Vec3>(turned_by({0, 0, 1}, speed * h * k));
    p.contact.mean_spin = Real(dot(spin, static_cast<Vec3d>(p.contact.normal)));
    (void)p.step(h);
  }
  const Vec3d expected = turned_by(force, speed * h * steps);
  // A turn in 50,000 steps of single precision, 3e-9 of the length lost in each; the spin is that of the step's end.
  CHECK(length(static_cast<Vec3d>(p.history.force)) == Approx(length(force)).epsilon(3e-4));
  CHECK(length(static_cast<Vec3d>(p.history.force) - expected) < 1e-3 * length(force));
  CHECK(length(static_cast<Vec3d>(p.history.moment) - turned_by(moment, speed * h * steps)) < 1e-3 * length(moment));
}

TEST_CASE("the pull-off force is 3/2 pi w R by JKR and 2 pi w R by DMT") {
  CHECK(pull_off(Adhesion::jkr) == Approx(1.5).epsilon(2e-3));
  CHECK(pull_off(Adhesion::dmt) == Approx(2.0).epsilon(2e-3));
}

TEST_CASE("a JKR contact begins at touch and parts beyond it, at 5/9 of its pull-off force") {
  PenaltyLaw law = steel_like(0.3);
  law.work_of_adhesion = 0.2f;
  law.adhesion = Adhesion::jkr;
  Pair p(law);
  p.contact.gap = 1e-9f;
  CHECK(p.step(1e-5).force.z == 0);  // not yet
  p.contact.gap = -1e-9f;
  // At zero overlap 8/9 of the pull-off force act, 4/3 pi w R.
  CHECK(p.step(1e-5).force.z == Approx(-4.0 / 3 * kPi * 0.2 * kRadius / 2).epsilon(5e-3));
  double last = 0;
  for (double gap = 0;; gap += 1e-10) {
    p.contact.gap = Real(gap);
    const double force = p.step(1e-5).force.z;
    if (force == 0) break;
    last = force;
    REQUIRE(gap < 1e-5);
  }
  CHECK(last == Approx(-5.0 / 6 * kPi * 0.2 * kRadius / 2).epsilon(0.03));
}

TEST_CASE("a sphere hangs from a plane by JKR up to its pull-off force and falls above") {
  const double mass = kDensity * 4.0 / 3 * kPi * kRadius * kRadius * kRadius;
  for (const Backend backend : backends())
    for (const double share : {0.95, 1.05}) {
      PenaltyLaw law = soft_law(0.3);
      law.adhesion = Adhesion::jkr;
      law.work_of_adhesion = Real(mass * kGravity / (share * 1.5 * kPi * kRadius));
      SceneWorld w = open_world({});
      add_plane(w, {}, about_x(kPi));  // looks down
      w.add_sphere({0, 0, -kRadius + 1e-7}, Real(kRadius), Real(kDensity), 0);
      w.gravity = {};
      const StepSettings s = at_share(w, penalty_settings(ContactLaw::hertz, law, 0), 0.5);
      const auto simulation = simulate(backend, w, s);
      for (int k = 1; k <= 100; ++k) {  // slowly to its weight
        simulation->set_gravity(0, {0, 0, Real(-kGravity * k / 100)});
        advance_for(*simulation, 1e-3);
      }
      advance_for(*simulation, 0.1);
      const bool hangs = simulation->body(0, 1).position.z > -1.01 * kRadius;
      CHECK(hangs == (share < 1));
    }
}
