// Numbers without dimension: canonical wheels have the numbers they were made from, at every size and gravity.
#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/vehicles.h"
#include "vehicle/family/numbers.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

Family shipped_family() { return read_family(Config::read(GONOGO_SOURCE_DIR "/configs/families/wheel.json")); }

constexpr WheelNumbers kLugged{.load = 1.7, .width = 0.3, .deflection = 0.04, .lug = 0.03};

}  // namespace

TEST_CASE("a canonical wheel has the numbers it was made from, at every size and gravity") {
  for (const double diameter : {0.25, 1.0, 2.0})
    for (const double gravity : {kGravity, kGravity / 3, kGravity / 6}) {
      Family family = shipped_family();
      family.diameter = diameter;
      const Vehicle v = canonical_wheel(family, kLugged, gravity);
      const double load = weigh(v).total * gravity;
      const WheelNumbers n = wheel_numbers(v.wheel.front(), load, gravity);
      CHECK(n.load == Approx(kLugged.load));
      CHECK(n.width == Approx(kLugged.width));
      CHECK(n.deflection == Approx(kLugged.deflection));
      CHECK(n.lug == Approx(kLugged.lug));
      CHECK(load == Approx(load_of(family, kLugged, gravity)));
      // Slonaker's group rho D L^2 / M, with the width D and the radius L.
      const Wheel& w = v.wheel.front();
      CHECK(kFamilyDensity * w.width * w.radius * w.radius / weigh(v).total == Approx(1 / (4 * kLugged.load)));
    }
}

TEST_CASE("scaled wheels swing and turn alike in units of sqrt(D / g)") {
  const Family one = shipped_family();
  Family small = one;
  small.diameter = one.diameter / 4;
  const double gravity = kGravity / 6, time = std::sqrt(small.diameter / gravity) / std::sqrt(one.diameter / kGravity);
  const Vehicle a = canonical_wheel(one, kLugged, kGravity), b = canonical_wheel(small, kLugged, gravity);
  const double mass = weigh(b).total / weigh(a).total;
  CHECK(mass == Approx(1.0 / 64));
  const auto alike = [&](const LinearSpring& x, const LinearSpring& y) {
    CHECK(y.stiffness == Approx(x.stiffness * mass / (time * time)));
    CHECK(y.damping == Approx(x.damping * mass / time));
  };
  alike(a.suspension.front().upright_spring, b.suspension.front().upright_spring);
  alike(a.wheel.front().compliant, b.wheel.front().compliant);
  CHECK(b.wheel.front().part.moments.y == Approx(a.wheel.front().part.moments.y * mass / 16));
  CHECK(largest_drive_torque(b) == Approx(largest_drive_torque(a) * mass / 4 / 6));
}

TEST_CASE("hardly compliant tyres are rigid, and hardly lugged wheels smooth") {
  const Vehicle v =
      canonical_wheel(shipped_family(), {.load = 1, .width = 0.2, .deflection = 0.004, .lug = 0.004}, kGravity);
  CHECK(v.wheel.front().compliant.stiffness == 0);
  CHECK(v.wheel.front().lug_count == 0);
}

TEST_CASE("the numbers of the HMMWV's wheel are those of its file") {
  const Vehicle v = read_quarter_vehicle(GONOGO_SOURCE_DIR "/configs/vehicles/hmmwv_quarter.json");
  const double load = weigh(v).total * kGravity;
  const WheelNumbers n = wheel_numbers(v.wheel.front(), load, kGravity);
  CHECK(n.load == Approx(643.2 / (1600 * 0.254 * 0.934 * 0.934)));
  CHECK(n.width == Approx(0.254 / 0.934));
  CHECK(n.deflection == Approx(643.2 * 9.81 / 163000 / 0.934));
  CHECK(n.lug == Approx(0.02 / 0.934));
}

TEST_CASE("a family's file is refused for what is out of range") {
  const std::string text = R"({"vehicle": "f", "kind": "family", "about": "a", "sources": ["s"], "diameter_m": 9,
                               "friction": 0.8, "wheel_mass_share": 0.2, "spring_Hz": 2,
                               "lugs": {"count": 24, "thickness_ratio": 0.02}})";
  refused([&] { read_family(Config::parse(text, "f.json")); }, "diameter_m");
}

}  // namespace gonogo::vehicle
