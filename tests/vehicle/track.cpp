// Tracks: the loop of shoes, and a whole tracked vehicle on hard ground against closed forms.
#include <cmath>

#include "base/units.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/joint_error.h"
#include "tests/support/measure.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"
#include "tests/support/vehicles.h"
#include "vehicle/hard_ground/track_checks.h"
#include "vehicle/model/statics.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;

namespace {

Vehicle m113() { return shipped_vehicle("m113"); }

void all_agree(const HardGroundReport& r) {
  CHECK(!r.check.empty());
  for (const HardGroundCheck& c : r.check) CHECK(agrees(c.claim, c.expected, c.measured, c.tolerance));
}

/// Distance of a point from the line between two others, in the plane x, z.
double from_chord(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d way = b - a;
  const double along = std::clamp(dot(p - a, way) / dot(way, way), 0.0, 1.0);
  return length(p - (a + along * way));
}

}  // namespace

TEST_CASE("a track's shoes close in chords of one pitch, in the sprocket's seats and beside every wheel") {
  const Vehicle v = set_down(m113());
  const Track& t = *v.track;
  CHECK(sprocket_teeth(t) == 10);
  for (const bool left : {true, false}) {
    const TrackLoop loop = close_loop(v, left);
    const std::size_t count = loop.pin.size();
    REQUIRE(count == std::size_t(left ? t.left_shoes : t.right_shoes));
    CHECK((loop.tension >= 0 && loop.tension <= 1));
    int seated = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3d a = loop.pin[k], b = loop.pin[(k + 1) % count];
      CHECK(std::fabs(length(b - a) - t.shoe_pitch) < 1e-9);
      const Vec3d from = a - t.sprocket.centre;
      if (std::fabs(length(from) - t.sprocket_radius) < 1e-9) {
        ++seated;
        // Teeth stand half-way between pins.
        const double turns = (std::atan2(from.z, from.x) - loop.tooth_angle) * 10 / (2 * kPi);
        CHECK(std::fabs(std::fabs(turns - std::floor(turns)) - 0.5) < 1e-3);
      }
      CHECK(from_chord(loop.idler, a, b) > t.idler_radius + t.pad_above_pin - 1e-9);
      for (const Station& s : stations(v))
        if ((s.side > 0) == left)
          CHECK(from_chord({s.centre.x, 0, s.centre.z}, a, b) > s.wheel->radius + t.pad_above_pin - 1e-9);
    }
    CHECK(seated >= 4);  // of ten, along somewhat less than half a turn
  }
}

TEST_CASE("arms are set down where their springs would carry the load, as far as the belts allow") {
  Vehicle design = m113();
  for (Suspension& s : design.suspension) s.torsion.preload = 4000;
  const Vehicle v = set_down(design);
  const auto before = stations(design), after = stations(v);
  const TorsionSpring was = design.suspension[0].torsion, is = v.suspension[0].torsion;
  const double angle = (was.preload - is.preload) / was.stiffness;
  CHECK(angle > 0.05);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Vec3d pivot = before[i].mount + Vec3d{0.288, 0, 0.134}, from = before[i].centre - pivot,
                to = after[i].centre - pivot;
    CHECK(std::fabs(std::hypot(from.x, from.z) - std::hypot(to.x, to.z)) < 1e-9);
    CHECK(std::fabs(std::acos((from.x * to.x + from.z * to.z) / (std::hypot(from.x, from.z) * std::hypot(to.x, to.z))) -
                    angle) < 1e-6);
    CHECK(to.z < from.z);
  }
  CHECK(std::fabs(weigh(v).total - weigh(design).total) < 1e-9);
  // The belly stays where it is in the chassis.
  CHECK(std::fabs(weigh(v).ground + v.clearance - weigh(design).ground - design.clearance) < 1e-9);
}

TEST_CASE("the engine's tracked vehicle has the mass of its file, moment by moment") {
  const Vehicle v = set_down(m113());
  const HardGround ground(v, {}, 0.8);
  double mass = 0;
  for (const sim::BodyMass& m : ground.world.mass)
    if (m.inverse_mass.x > 0) mass += 1 / double(m.inverse_mass.x);
  CHECK(agrees("mass of chassis, running gear and shoes [kg]", weigh(v).total, mass, 0.01));
}

TEST_CASE("a tracked vehicle at rest loads the ground with its weight, and its tensioners tension its belts") {
  for (const sim::Backend backend : backends()) all_agree(check_belts_at_rest(m113(), {backend, 1}));
}

TEST_CASE("two turns of the sprockets drive a tracked vehicle by twice their teeth times the pitch") {
  for (const sim::Backend backend : backends()) all_agree(check_track_speed(m113(), 6, {backend, 1}));
}

TEST_CASE("spinning belts pull what friction allows: tan = mu") {
  for (const sim::Backend backend : backends()) all_agree(check_track_traction(m113(), 0.3, {backend, 1}));
}

TEST_CASE("slowly uphill the ground holds the weight's share, and the sprockets' torque over their radius is that") {
  for (const sim::Backend backend : backends()) all_agree(check_track_torque(m113(), 0.22, {backend, 1}));
}

TEST_CASE("a tracked vehicle drives with the same bits on one and two threads") {
  const Vehicle v = set_down(m113());
  DriverOrders orders;
  orders.throttle_ramp = 0.1;
  const HardGround ground(v, orders, 0.8);
  sim::StepSettings settings = settings_with(20);
  std::vector<sim::BodyState> end[2];
  for (int threads : {1, 2}) {
    const auto s = sim::make_simulation(sim::Backend::cpu, sim::Scene{ground.world}, settings, threads);
    s->advance(60);
    end[threads - 1] = s->bodies(0);
  }
  int moved = 0;
  for (std::size_t i = 0; i < end[0].size(); ++i) {
    const sim::BodyState &a = end[0][i], &b = end[1][i];
    CHECK((a.position.x == b.position.x && a.position.y == b.position.y && a.position.z == b.position.z));
    CHECK((a.velocity.x == b.velocity.x && a.angular_velocity.y == b.angular_velocity.y));
    CHECK((a.orientation.w == b.orientation.w && a.orientation.y == b.orientation.y));
    moved += a.velocity.x != 0;
  }
  CHECK(moved > 100);
}

TEST_CASE("belts that cannot be are refused by a sentence that says why") {
  const auto built = [](const std::string& from, const std::string& to) {
    return input_error([&] { HardGround(set_down(changed_vehicle("m113", from, to)), {}, 0.8); });
  };
  CHECK(contains(built("\"radius_m\": 0.2492", "\"radius_m\": 0.26"), "track.sprocket.radius_m"));
  CHECK(contains(built("\"belt\": {", "\"belt\": { \"colour\": 1,"), "colour"));
  CHECK(contains(built("[0.0284, 0.0114, 0.045]", "[0.0284, 0.06, 0.045]"), "narrower than wheel_gap_m"));
  CHECK(contains(built("\"right_count\": 64", "\"right_count\": 65"), "the loop does not close"));
  CHECK(contains(built("\"force_N\": 20000", "\"force_N\": -1"), "tensioner.force_N"));
}
