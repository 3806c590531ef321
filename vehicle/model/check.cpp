// What can only be judged across the sections of a vehicle file.
#include <algorithm>
#include <cmath>
#include <set>

#include "base/format.h"
#include "base/nearest.h"
#include "vehicle/model/belt.h"
#include "vehicle/model/read.h"

namespace gonogo::vehicle {
namespace {

template <class Item>
void require_known(const Config& c, const std::string& key, const std::string& what, const std::vector<Item>& items,
                   const std::string& name) {
  std::vector<std::string> names;
  for (const Item& item : items) names.push_back(item.name);
  if (std::find(names.begin(), names.end(), name) == names.end())
    c.fail(key, "no " + what + " \"" + name + "\" in this file; it has: " + join_words(names));
}

void check_axles(const Config& c, const Vehicle& v) {
  const auto sections = c.objects("axles");
  if (sections.empty()) c.fail("axles", "a vehicle needs at least one axle");
  std::set<std::string> names;
  bool driven = false;
  for (std::size_t i = 0; i < v.axle.size(); ++i) {
    const Axle& a = v.axle[i];
    require_known(sections[i], "suspension", "suspension", v.suspension, a.suspension);
    require_known(sections[i], "wheel", "wheel", v.wheel, a.wheel);
    if (!names.insert(a.name).second) sections[i].fail("name", "two axles are named \"" + a.name + "\"");
    const double out = find_suspension(v, a.suspension).point.at("wheel").y + a.position.y;
    if (!a.single && out < 0.5 * find_wheel(v, a.wheel).width)
      sections[i].fail("suspension",
                       "the left and the right wheel overlap; put the wheel's y further out, or set single");
    if (a.steered && v.max_steering_angle <= 0) sections[i].fail("steered", "needs \"steering\" with max_angle_deg");
    driven = driven || a.driven;
  }
  if (!driven) c.fail("axles", "no axle is driven; set \"driven\": true on at least one");
  if (v.kind == VehicleKind::single_wheel && (v.axle.size() != 1 || !v.axle[0].single))
    c.fail("axles", "a single-wheel rig has one axle with \"single\": true");
}

/// Springs must be between their stops in the design position.
void check_springs(const Config& c, const Vehicle& v) {
  for (const Suspension& s : v.suspension) {
    if (s.type != SuspensionType::double_wishbone || s.spring.stop.empty()) continue;
    const double now = length(s.point.at("spring_chassis") - s.point.at("spring_arm"));
    if (now < s.spring.shortest || now > s.spring.longest)
      c.fail("suspensions." + s.name + ".spring.stops",
             "the spring is " + number_text(now, 5) + " m long in the design position, outside its stops");
  }
}

}  // namespace

void check_belt(const Config& c, const Vehicle& v) {
  const Track& t = v.track[0];
  for (const bool left : {true, false}) {
    const int count = left ? t.left_shoes : t.right_shoes;
    const double length = count * t.shoe_pitch;
    const double loose = belt_length(v, left, 0), tight = belt_length(v, left, 1);
    // Half a pitch of slack hangs between the wheels.
    if (length > std::max(loose, tight) + 0.5 * t.shoe_pitch || length < std::min(loose, tight))
      c.fail(std::string("track.shoe.") + (left ? "left_count" : "right_count"),
             "the loop does not close: " + std::to_string(count) + " shoes make " + number_text(length, 5) +
                 " m, the way around the wheels is " + number_text(loose, 5) + " to " + number_text(tight, 5) + " m");
  }
}

void check_vehicle(const Config& c, const Vehicle& v) {
  if (v.kind == VehicleKind::tracked) {
    const Config wheels = c.object("track").object("road_wheels");
    require_known(wheels, "wheel", "wheel", v.wheel, v.track[0].wheel);
    require_known(wheels, "suspension_with_damper", "suspension", v.suspension, v.track[0].suspension_with_damper);
    require_known(wheels, "suspension", "suspension", v.suspension, v.track[0].suspension);
    check_belt(c, v);
  } else {
    check_axles(c, v);
  }
  check_springs(c, v);
}

}  // namespace gonogo::vehicle
