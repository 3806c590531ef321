// A tyre under load, pressed and rolling: balance of forces and of energy, loss against its closed form.
#include <numbers>

#include "sim/elastic/tyre/press.h"
#include "sim/elastic/tyre/roll.h"
#include "sim/elastic/tyre/tread.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace {

using namespace gonogo;
using namespace gonogo::sim::elastic;

Tyre car_tyre(double loss, double friction = 0) {
  return {.radius = 0.31,
          .tread = 0.01,
          .rim_radius = 0.19,
          .width = 0.15,
          .bulge = 0.035,
          .pressure = 2e5,
          .bending = 3,
          .stretching = 1e6,
          .tangential = 4e5,
          .belt_mass = 7,
          .loss = loss,
          .nodes = 96,
          .law = penalty_law(3e8, friction, 0.05)};
}

constexpr double kLoad = 3000, kSpeed = 15;  // [N], [m/s]

RollingTyre rolling(const Tyre& t, double slip = 0) {
  return RollingTyre(t, {.speed = kSpeed,
                         .spin = -kSpeed * (1 + slip) / t.belt_radius(),
                         .load = kLoad,
                         .mass = kLoad / 9.81,
                         .damping = 6000});
}

struct Steady {
  RollMeans mean;
  RollEnergy energy;
};

Steady steady(RollingTyre tyre) {
  const double step = 0.9 * tyre.critical_step();
  roll(tyre, step, 2);
  Steady s;
  s.mean = roll(tyre, step, 2);
  s.energy = tyre.energy();
  return s;
}

}  // namespace

TEST_CASE("The ground carries what the hub bears, and the sum over the tread is the load of the sidewalls") {
  Tyre t = car_tyre(0);
  t.nodes = 240;
  PressedTyre tyre(t, 0.33);
  REQUIRE(tyre.carry(kLoad));
  CHECK(tyre.contact_load() == Approx(kLoad).epsilon(1e-6));
  CHECK(tyre.rim_load().y == Approx(tyre.contact_load()).epsilon(1e-7));
  CHECK(std::fabs(tyre.rim_load().x) < 1e-6 * kLoad);
  CHECK(std::fabs(tyre.rim_load().moment) < 1e-6 * kLoad * t.radius);
  const double before = tyre.contact_length();
  REQUIRE(tyre.move_rim({.x = 0.02, .y = tyre.rim().y, .turn = 0.013}));  // 0.5 of a node's pitch and less
  CHECK(tyre.contact_load() == Approx(kLoad).epsilon(2e-3));
  CHECK(tyre.contact_length() == Approx(before).epsilon(0.02));
}

TEST_CASE("A finer ring finds the same deflection") {
  std::vector<double> height;
  for (const int nodes : {120, 240, 480}) {
    Tyre t = car_tyre(0);
    t.nodes = nodes;
    PressedTyre tyre(t, 0.33);
    REQUIRE(tyre.carry(kLoad));
    height.push_back(t.radius - tyre.rim().y);
  }
  CHECK(height[0] == Approx(height[2]).epsilon(0.02));
  CHECK(height[1] == Approx(height[2]).epsilon(0.007));
}

TEST_CASE("Branches have the loss factor and stiffness that they are made for") {
  for (const double loss : {0.05, 0.2, 0.3}) {
    const Rubber r = rubber_of(loss);
    const Moduli m = moduli_of(r.branch, kRate[1]);
    CHECK(m.loss / m.storage == Approx(loss));
    CHECK(r.settled * m.storage == Approx(1));
    for (const double w : {100.0, 250.0, 1000.0, 3000.0}) {
      const Moduli at = moduli_of(r.branch, w);
      CHECK(at.loss / at.storage == Approx(loss).epsilon(0.35));
    }
  }
}

TEST_CASE("A tread that is pressed in a cycle loses pi E'' s^2, and a free one recovers without force") {
  const Rubber r = rubber_of(0.2);
  const double stiffness = 1e5, depth = 2e-3, swing = 5e-4, w = 400, h = 1e-6;
  LossyTread tread(1, stiffness, r);
  const double cycle = 2 * std::numbers::pi / w;
  double lost = 0, work = 0;
  const long steps = std::lround(cycle / h);
  for (long i = 0; i < 40 * steps; ++i) {
    const double s = depth + swing * std::sin(w * double(i) * h);
    const double before = tread.pressing()[0];
    const double now = tread.follow({-s}, h);
    if (i < 39 * steps) continue;
    lost += now;
    work += stiffness * (before + tread.pressing()[0]) / 2 * (s - depth - swing * std::sin(w * double(i - 1) * h));
  }
  const Moduli m = moduli_of(r.branch, w);
  const double expected = std::numbers::pi * r.settled * m.loss * stiffness * swing * swing;
  CHECK(lost == Approx(expected).epsilon(2e-3));
  CHECK(work == Approx(expected).epsilon(1e-2));

  const double energy = tread.energy();
  double given = 0, recovered = 0;  // to the ground that withdraws; lost on the way
  for (int i = 0; i < 200000; ++i) {
    const double before = tread.pressing()[0];
    recovered += tread.follow({-depth + 1e-7 * i}, h);
    given += stiffness * (before + tread.pressing()[0]) / 2 * 1e-7;
  }
  CHECK(tread.pressing()[0] == 0);
  CHECK(given > 0.3 * energy);
  CHECK(given + recovered + tread.energy() == Approx(energy).epsilon(2e-3));
  CHECK(tread.energy() < 1e-3 * energy);
}

TEST_CASE("Without loss and friction a tyre rolls for nothing") {
  const Steady s = steady(rolling(car_tyre(0)));
  CHECK(s.mean.load == Approx(kLoad).epsilon(0.01));
  CHECK(std::fabs(s.mean.torque) < 5e-4 * kLoad * 0.31);  // vibrations of two turns
  CHECK(s.energy.loss == 0);
  CHECK(std::fabs(s.energy.balance()) < 0.01);
}

TEST_CASE("What the hub works is lost in the rubber, in proportion to the loss factor") {
  const Steady low = steady(rolling(car_tyre(0.05))), high = steady(rolling(car_tyre(0.1)));
  for (const Steady* s : {&low, &high}) {
    CHECK(s->mean.load == Approx(kLoad).epsilon(0.01));
    CHECK(s->mean.worked == Approx(s->mean.lost).epsilon(0.03));  // a hub that still rocks stores a little
    CHECK(s->mean.torque / 0.3 == Approx(s->mean.worked).epsilon(5e-3));
    CHECK(std::fabs(s->energy.balance()) < 5e-4 * s->energy.work);
  }
  CHECK(high.mean.lost / low.mean.lost == Approx(2).epsilon(0.05));
}

TEST_CASE("Friction drives a tyre that turns too fast, up to its coefficient, and its work is accounted for") {
  const Steady slow = steady(rolling(car_tyre(0.1, 0.8), 0.002)), fast = steady(rolling(car_tyre(0.1, 0.8), 0.05));
  CHECK(slow.mean.pull > 0.1 * kLoad);
  CHECK(slow.mean.pull < fast.mean.pull);
  CHECK(fast.mean.pull == Approx(0.8 * kLoad).epsilon(0.02));
  CHECK(fast.energy.friction > slow.energy.friction);
  for (const Steady* s : {&slow, &fast}) CHECK(std::fabs(s->energy.balance()) < 3e-3 * s->energy.work);
}

TEST_CASE("Steps above the critical one are refused, and lead nowhere") {
  RollingTyre tyre = rolling(car_tyre(0.1));
  const double critical = tyre.critical_step();
  CHECK(input_error([&] { tyre.advance(1.01 * critical, 1); }).find("tyre: the step is ") == 0);
  tyre.advance(0.98 * critical, 20000);
  CHECK(std::fabs(tyre.energy().balance()) < 1);
  CHECK(input_error([] {
          rolling([] {
            Tyre t = car_tyre(0);
            t.belt_mass = 0;
            return t;
          }());
        }) == "tyre: the mass of the belt is 0 kg; to roll it must be above 0");
  CHECK(input_error([] { RollingTyre(car_tyre(0), {.load = 100}); }) ==
        "tyre: the mass that the hub carries is 0 kg; with a load it must be above 0");
  Tyre rough = car_tyre(0.1);
  rough.law.m_n = 2;
  CHECK(input_error([&] { rolling(rough); }) == "tyre: the tread's exponent m_n is 2; with a loss factor it must be 1");
}
