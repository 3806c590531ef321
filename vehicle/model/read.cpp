#include "vehicle/model/read.h"

#include <cmath>

#include "base/error.h"
#include "base/units.h"

namespace gonogo::vehicle {
namespace {

/// Leading minors of the inertia matrix: all positive for a body that resists every rotation.
bool positive_definite(const Part& p) {
  const Vec3d &m = p.moments, &o = p.products;
  const double second = m.x * m.y - o.x * o.x;
  const double third = m.x * (m.y * m.z - o.z * o.z) - o.x * (o.x * m.z - o.z * o.y) + o.y * (o.x * o.z - m.y * o.y);
  return m.x > 0 && second > 0 && third > 0;
}

Driver read_driver(const Config& c) {
  Driver d;
  d.throttle_start = c.number_or("throttle_start_s", 0, {0, 1e4});
  d.throttle_ramp = c.number_or("throttle_ramp_s", 0, {0, 1e4});
  d.speed = c.number_or("speed_m_s", 0, {0, 100});
  d.look_ahead = c.number_or("look_ahead_m", 0, {0, 1000});
  d.steering_gain = c.number_or("steering_gain_rad_m", 0, {0, 100});
  c.finish();
  return d;
}

void read_chassis(const Config& c, Vehicle& v) {
  v.chassis = read_part(c, "chassis", true);
  v.length = c.number("length_m", kLength);
  v.width = c.number("width_m", kLength);
  v.clearance = c.number("clearance_m", {0, 10});
  if (c.has("parts"))
    for (const Config& part : c.objects("parts")) {
      v.fixed_parts.push_back(read_part(part, part.text("name"), true));
      part.finish();
    }
  c.finish();
}

VehicleKind kind_of(const std::string& word) {
  if (word == "tracked") return VehicleKind::tracked;
  return word == "single_wheel" ? VehicleKind::single_wheel : VehicleKind::wheeled;
}

void read_sections(const Config& c, Vehicle& v) {
  read_chassis(c.object("chassis"), v);
  for (const auto& [name, section] : c.object("suspensions").members())
    v.suspension.push_back(read_suspension(section, name));
  for (const auto& [name, section] : c.object("wheels").members()) v.wheel.push_back(read_wheel(section, name));
  if (v.kind == VehicleKind::tracked)
    v.track.push_back(read_track(c.object("track")));
  else
    for (const Config& axle : c.objects("axles")) v.axle.push_back(read_axle(axle));
  if (const auto steering = c.object_if("steering")) {
    v.max_steering_angle = steering->number("max_angle_deg", {0, 90}) * kDegree;
    steering->finish();
  }
  const Config driveline = c.object("driveline");
  v.power = driveline.number("power_W", {0, 1e8});
  v.automatic = driveline.boolean_or("automatic", true);
  v.driveline = read_driveline(driveline);
  if (const auto driver = c.object_if("driver")) v.driver = read_driver(*driver);
}

}  // namespace

Vec3d read_vector(const Config& c, const std::string& key, Range range) {
  const auto n = c.numbers(key, range);
  if (n.size() != 3) c.fail(key, "needs 3 numbers [x, y, z], has " + std::to_string(n.size()));
  return {n[0], n[1], n[2]};
}

Curve read_curve(const Config& c, const std::string& at, const std::string& value, Range range) {
  Curve curve{c.numbers(at), c.numbers(value, range)};
  if (curve.at.size() < 2) c.fail(at, "needs at least 2 points");
  if (curve.at.size() != curve.value.size())
    c.fail(value, "has " + std::to_string(curve.value.size()) + " values for the " + std::to_string(curve.at.size()) +
                      " points of " + at);
  for (std::size_t i = 1; i < curve.at.size(); ++i)
    if (!(curve.at[i] > curve.at[i - 1])) c.fail(at + "[" + std::to_string(i) + "]", "must be above the one before it");
  return curve;
}

Part read_part(const Config& c, const std::string& name, bool placed) {
  Part p;
  p.name = name;
  p.mass = c.number("mass_kg", kMass);
  if (placed) p.centre = read_vector(c, "centre_m");
  p.moments = read_vector(c, "inertia_kg_m2", {1e-9, 1e9});
  if (c.has("products_kg_m2")) p.products = read_vector(c, "products_kg_m2", {-1e9, 1e9});
  if (!positive_definite(p))
    c.fail("products_kg_m2", "no body has these moments and products: the matrix is not positive");
  return p;
}

Differential read_differential(const Config& c, const std::string& key, double& bias) {
  if (!c.has(key)) return Differential::open;
  const std::string word = c.choice(key, {"open", "limited_slip", "locked"});
  if (word == "limited_slip") {
    bias = c.number("torque_bias", {1, 100});
    return Differential::limited_slip;
  }
  return word == "locked" ? Differential::locked : Differential::open;
}

Axle read_axle(const Config& c) {
  Axle a;
  a.name = c.text("name");
  a.position = read_vector(c, "position_m");
  a.suspension = c.text("suspension");
  a.wheel = c.text("wheel");
  a.single = c.boolean_or("single", false);
  a.driven = c.boolean_or("driven", false);
  a.steered = c.boolean_or("steered", false);
  a.brake_torque = c.number_or("brake_torque_N_m", 0, {0, 1e7});
  a.differential = read_differential(c, "differential", a.torque_bias);
  c.finish();
  return a;
}

Vehicle read_vehicle(const std::filesystem::path& path) { return read_vehicle(Config::read(path)); }

Vehicle read_vehicle(const Config& c) {
  Vehicle v;
  v.name = c.text("vehicle");
  v.kind = kind_of(c.choice("kind", {"wheeled", "tracked", "single_wheel"}));
  v.about = c.text("about");
  v.sources = c.texts("sources");
  if (v.sources.empty()) c.fail("sources", "say where the numbers come from");
  if (c.has("unsourced")) v.unsourced = c.texts("unsourced");
  read_sections(c, v);
  c.finish();
  check_vehicle(c, v);
  return v;
}

}  // namespace gonogo::vehicle
