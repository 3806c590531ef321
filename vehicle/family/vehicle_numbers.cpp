#include "vehicle/family/vehicle_numbers.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "vehicle/family/data_sheet.h"
#include "vehicle/model/assembly.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

void check_is_member(const Vehicle& v) {
  if (v.kind != VehicleKind::wheeled)
    throw InputError(v.name + ": the family has whole wheeled vehicles, and this is " +
                     (v.track ? "one on tracks" : "a wheel by itself"));
  if (v.axle.size() < 2 || v.axle.size() > 4)
    throw InputError(v.name + ": has " + std::to_string(v.axle.size()) + " axles; the family has vehicles of 2 to 4");
}

/// Largest power at the treads [W].
double largest_power(const Vehicle& v) {
  constexpr int steps = 400;
  const TractiveForce force(v);
  double most = 0;
  for (int i = 1; i <= steps; ++i) {
    const double speed = force.top_speed() * i / steps;
    most = std::max(most, force.at(speed) * speed);
  }
  return most;
}

}  // namespace

VehicleNumbers vehicle_numbers(const Vehicle& v, double gravity) {
  check_is_member(v);
  const auto wheels = stations(v);
  const Weights w = weigh(v);
  const double weight = w.total * gravity, diameter = 2 * wheels.front().wheel->radius;
  double front = -1e9, rear = 1e9, track = 0;
  for (const Station& s : wheels) {
    front = std::max(front, s.centre.x);
    rear = std::min(rear, s.centre.x);
    track = std::max(track, 2 * std::fabs(s.centre.y));
  }
  VehicleNumbers n{.wheel = wheel_numbers(*wheels.front().wheel, weight / double(wheels.size()), gravity)};
  n.axles = int(v.axle.size());
  n.axle_gap = (front - rear) / diameter - (n.axles - 1);
  n.track = track / diameter;
  n.centre_height = (w.centre.z - w.ground) / diameter;
  n.centre_behind = (front - w.centre.x) / (front - rear);
  n.clearance = v.clearance / diameter;
  const double time = std::sqrt(gravity * diameter);
  for (const GearSpeed& g : gear_speeds(v)) {
    n.force = std::max(n.force, g.tractive_force / weight);
    n.top_speed = std::max(n.top_speed, g.balanced / time);
  }
  n.power = largest_power(v) / (weight * time);
  return n;
}

VehicleNumbers loaded(VehicleNumbers n, double mass_ratio) {
  n.wheel.load *= mass_ratio;
  n.wheel.deflection *= mass_ratio;
  n.force /= mass_ratio;
  n.power /= mass_ratio;
  return n;
}

Vehicle canonical_vehicle(const Family& f, const VehicleNumbers& n, double gravity) {
  const double d = f.diameter, speed = std::sqrt(gravity * d), lug = n.wheel.lug < kNegligible ? 0 : n.wheel.lug * d;
  const double base = (n.axle_gap + n.axles - 1) * d, weight = 2 * n.axles * load_of(f, n.wheel, gravity);
  DataSheet s;
  s.name = f.name;
  s.mass = weight / gravity;
  s.axles = n.axles;
  s.wheelbase = {base};
  s.track = n.track * d;
  s.tyre = bare_wheel(d + 2 * lug, n.wheel.width * d);
  s.tread_width = n.wheel.width * d;
  s.deflection = n.wheel.deflection < kNegligible ? 0 : n.wheel.deflection * d;
  s.power = n.power * weight * speed;
  s.top_speed = n.top_speed * speed;
  s.clearance = n.clearance * d;
  s.centre_height = n.centre_height * d;
  s.centre_behind = n.centre_behind * base;
  s.lug_height = lug;
  s.lug_count = lug > 0 ? f.lug_count : 0;
  s.lug_thickness = f.lug_thickness * d;
  s.driven_axles = n.axles;
  s.tractive_force = n.force;
  s.friction = f.friction;
  s.build = Build::sprung;
  s.drive = Power::wheel_motors;
  s.ride_hz = f.spring_hz * std::sqrt(gravity / kGravity / d);
  s.gravity = gravity;
  s.sources = f.sources;
  return read_vehicle(Config::parse(vehicle_file(s).json.dump(), f.name));
}

std::vector<double> axle_shares(const VehicleNumbers& v, double slope) {
  const double n = v.axles, base = v.axle_gap + n - 1;
  const double centre = v.centre_behind * base + v.centre_height * std::tan(slope);  // of pressure, behind the first
  double spread = 0;
  for (int i = 0; i < v.axles; ++i) spread += std::pow(base * (i / (n - 1) - 0.5), 2);
  std::vector<double> shares;
  for (int i = 0; i < v.axles; ++i)
    shares.push_back(std::max(0.0, 1 / n + (centre - base / 2) * base * (i / (n - 1) - 0.5) / spread));
  double sum = 0;
  for (const double share : shares) sum += share;
  for (double& share : shares) share /= sum;
  return shares;
}

double drive_force(const VehicleNumbers& n, double speed) { return std::min(n.force, n.power / speed); }

std::vector<PlacedNumber> placed(const Family& f, const VehicleNumbers& n) {
  std::vector<PlacedNumber> list{
      {"load_number", "load of a wheel over the weight of soil in width times diameter squared", n.wheel.load, {}},
      {"width_ratio", "width of a wheel", n.wheel.width, {}},
      {"deflection_ratio", "static deflection of a tyre", n.wheel.deflection, {}},
      {"lug_ratio", "height of lugs", n.wheel.lug, {}},
      {"axles", "number of axles", double(n.axles), {}},
      {"axle_gap_ratio", "free length between the wheels of a side", n.axle_gap, {}},
      {"track_ratio", "distance of left and right wheels", n.track, {}},
      {"centre_height_ratio", "height of the centre of mass", n.centre_height, {}},
      {"centre_share", "place of the centre of mass behind the first axle, over the wheelbase", n.centre_behind, {}},
      {"clearance_ratio", "clearance of the belly", n.clearance, {}},
      {"force_number", "largest tractive force over weight", n.force, {}},
      {"power_number", "largest power over weight times sqrt(g D)", n.power, {}},
      {"top_speed_number", "top speed over sqrt(g D)", n.top_speed, {}}};
  for (PlacedNumber& p : list) p.range = f.range.at(p.name);
  return list;
}

double counted(const PlacedNumber& n) {
  if (n.name == "force_number" || n.name == "power_number" || n.name == "clearance_ratio" ||
      n.name == "top_speed_number")
    return std::min(n.value, n.range.maximum);
  return n.name == "centre_height_ratio" ? std::max(n.value, n.range.minimum) : n.value;
}

double excess(const PlacedNumber& n) {
  if (n.value < n.range.minimum) return n.range.minimum > 0 ? 1 - n.value / n.range.minimum : n.range.minimum - n.value;
  if (n.value > n.range.maximum) return n.value / n.range.maximum - 1;
  return 0;
}

std::string place_text(const PlacedNumber& n) {
  const double outside = excess(n);
  if (outside == 0) return "inside";
  return number_text(100 * outside, 2) + " % " + (n.value < n.range.minimum ? "below" : "above");
}

}  // namespace gonogo::vehicle
