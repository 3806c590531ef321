#include "vehicle/family/numbers.h"

#include <cmath>

#include "base/units.h"
#include "vehicle/family/tyre_size.h"

namespace gonogo::vehicle {
namespace {

constexpr double kSwingDamping = 0.5;  // of the sprung mass, over the critical one
constexpr double kTorquePerLoad = 5;   // largest torque over load times radius: the wheel's speed is imposed
constexpr double kLengthPerWheel = 1.2, kClearancePerWheel = 0.4;  // over the diameter; verdicts alone depend on them

Wheel canonical_tread(const Family& f, const WheelNumbers& n, double load) {
  Wheel w;
  w.name = "wheel";
  w.radius = f.diameter / 2;
  w.width = n.width * f.diameter;
  w.friction = f.friction;
  if (n.lug >= kNegligible) {
    w.lug_count = f.lug_count;
    w.lug_height = n.lug * f.diameter;
    w.lug_thickness = f.lug_thickness * f.diameter;
  }
  w.size_diameter = f.diameter;
  w.size_section_width = w.width;
  if (n.deflection >= kNegligible) w.compliant.stiffness = load / (n.deflection * f.diameter);
  return w;
}

}  // namespace

WheelNumbers wheel_numbers(const Wheel& w, double load, double gravity) {
  const double diameter = 2 * w.radius;
  return {.load = load / (kFamilyDensity * gravity * w.width * diameter * diameter),
          .width = w.width / diameter,
          .deflection = w.compliant.stiffness > 0 ? load / w.compliant.stiffness / diameter : 0,
          .lug = w.lug_count > 0 ? w.lug_height / diameter : 0};
}

bool is_family(const Config& c) { return c.has("kind") && c.text("kind") == "family"; }

Family read_family(const Config& c) {
  Family f;
  f.name = c.text("vehicle");
  c.choice("kind", {"family"});
  f.about = c.text("about");
  f.sources = c.texts("sources");
  f.diameter = c.number("diameter_m", {0.05, 5});
  f.friction = c.number("friction", {0, 5});
  f.wheel_mass = c.number("wheel_mass_share", {0.01, 0.9});
  f.spring_hz = c.number("spring_Hz", {0.1, 20});
  const Config lugs = c.object("lugs");
  f.lug_count = int(lugs.integer("count", {1, 200}));
  f.lug_thickness = lugs.number("thickness_ratio", {1e-4, 0.2});
  lugs.finish();
  const Config ranges = c.object("ranges");
  for (const char* name :
       {"load_number", "width_ratio", "deflection_ratio", "lug_ratio", "axles", "axle_gap_ratio", "track_ratio",
        "centre_height_ratio", "centre_share", "clearance_ratio", "force_number", "power_number", "top_speed_number"}) {
    const std::vector<double> ends = ranges.numbers(name, {0, 100});
    if (ends.size() != 2 || !(ends[0] < ends[1])) ranges.fail(name, "expected [smallest, largest]");
    f.range[name] = {ends[0], ends[1]};
  }
  ranges.finish();
  c.finish();
  return f;
}

MemberScale member_scale(const Family& family, double family_gravity, double diameter, double gravity) {
  const double length = diameter / family.diameter, stress = length * gravity / family_gravity;
  return {.length = length, .speed = std::sqrt(stress), .stress = stress};
}

double load_of(const Family& f, const WheelNumbers& n, double gravity) {
  return n.load * kFamilyDensity * gravity * n.width * f.diameter * f.diameter * f.diameter;
}

Vehicle canonical_wheel(const Family& f, const WheelNumbers& n, double gravity) {
  const double load = load_of(f, n, gravity), mass = load / gravity, own = f.wheel_mass * mass;
  Wheel wheel = canonical_tread(f, n, load);
  wheel.part = {.name = wheel.name, .mass = own, .moments = {0, 0.7 * own * wheel.radius * wheel.radius, 0}};
  wheel.compliant.damping = 2 * kTyreDamping * std::sqrt(wheel.compliant.stiffness * mass);
  const double turns = 2 * kPi * f.spring_hz * std::sqrt(gravity / kGravity / f.diameter), sprung = mass - own;
  const LinearSpring spring{sprung * turns * turns, 2 * kSwingDamping * sprung * turns};
  Vehicle v = quarter_vehicle(f.name, wheel, spring, sprung, kTorquePerLoad * load * wheel.radius);
  v.about = f.about;
  v.sources = f.sources;
  v.length = kLengthPerWheel * f.diameter;
  v.clearance = kClearancePerWheel * f.diameter;
  return v;
}

}  // namespace gonogo::vehicle
