#include "vehicle/family/data_sheet.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

// Rules, for what a data sheet does not say. Those that cite hmmwv.json scale Project Chrono's HMMWV.

constexpr double kSoftDeflection = 0.15;   // of the section height
constexpr double kTreadPerSection = 0.8;   // width of the tread over that of the section
constexpr double kWheelDensity = 250;      // mass of wheel and rim over D^2 b [kg/m^3]
constexpr double kMostWheelMass = 0.25;    // of the vehicle, all wheels together
constexpr double kStability = 1.2;         // half of the track over the height of the centre of mass
constexpr double kLugPerDiameter = 0.017;  // of pneumatic tyres
constexpr int kLugCount = 24;
constexpr double kLugThickness = 0.03;  // over the diameter
constexpr double kTractivePerWeight = 1.0;
constexpr double kEngineEfficiency = 0.85;  // from the engine to the tread
constexpr double kRideHz = 1.5, kRideDamping = 0.3;
constexpr double kSprungFrom = 300;  // [kg]
constexpr double kFrictionOfRubber = 0.8, kFrictionOfMetal = 0.5;
constexpr double kBraking = 0.8;                             // brake force of a wheel over its load
constexpr double kRoll = 0.33, kPitch = 0.26, kYaw = 0.286;  // radii of gyration over width, length and length
constexpr double kUpperArm = 0.009, kLowerArm = 0.037, kUpright = 0.03;  // of the load's mass on a wheel
constexpr double kSteeringDegrees = 30;
constexpr double kCutOff = 1.02;      // speed without torque, over the top speed
constexpr double kEngineSpeed = 314;  // at the top speed [rad/s]

[[noreturn]] void refuse(const std::string& what) { throw InputError("vehicle new: " + what); }

void require(const char* what, double x, double low, double high, const char* unit) {
  if (!(x >= low && x <= high))
    refuse(std::string(what) + ": " + number_text(x, 6) + " " + unit + " is given; allowed are " + number_text(low, 6) +
           " to " + number_text(high, 6) + " " + unit);
}

Json vector(double x, double y, double z) { return Json::Array{x, y, z}; }
Json numbers(const std::vector<double>& values) { return Json(values); }

/// Rounded to six digits, as a person would write a file.
double tidy(double x) { return x == 0 ? 0 : std::stod(line("%.6g", x)); }

/// The sheet with every number that it lacks.
struct Complete {
  DataSheet sheet;
  std::vector<double> axle_x;  // from the front axle backwards [m]
  std::vector<double> load;    // of a wheel of each axle [N]
  double tread_width, tread_radius, lug_height, lug_thickness, centre_height, centre_behind, tractive_force, friction;
  double deflection;            // under the mean load [m]
  double wheel_mass, arm_mass;  // wheel with hub; arms and upright of a wheel [kg]
  int lug_count, driven_axles;
  Build build;
  Power drive;
  std::vector<std::string> assumed;

  int wheels() const { return 2 * sheet.axles; }
  double weight() const { return sheet.mass * sheet.gravity; }
  double base() const { return axle_x.back(); }
  double mean_load() const { return weight() / wheels(); }
  double diameter() const { return sheet.tyre.diameter; }
  // Of the driver [m/s], [s]. Engines that pull little more than the weight need one who is soon at the pedal.
  double full_throttle_error() const { return 0.2 * std::sqrt(sheet.gravity * diameter()); }
  double integral_time() const { return 4 * std::sqrt(diameter() / sheet.gravity); }
  bool sprung() const { return build == Build::sprung; }
};

// Checks.

void check_sheet(const DataSheet& s) {
  if (s.name.empty()) refuse("name: missing; give the vehicle a name");
  require("mass", s.mass, 1, 100000, "kg");
  if (s.axles < 2 || s.axles > 4)
    refuse("axles: " + std::to_string(s.axles) + " are given; the family has vehicles of 2 to 4");
  require("track", s.track, 0.05, 6, "m");
  require("power", s.power, 0.1, 1e7, "W");
  require("top speed", s.top_speed, 0.001, 70, "m/s");
  require("gravity", s.gravity, 0.1, 30, "m/s2");
  require("clearance", s.clearance, 0, 3 * s.tyre.diameter, "m");
  if (s.inflation && !s.tyre.pneumatic())
    refuse("inflation: " + s.tyre.text + " is a wheel without a tyre; leave it out, or give its deflection");
  if (s.inflation) require("inflation", *s.inflation / 1e3, 5, 1000, "kPa");
  if (s.inflation && s.deflection) refuse("inflation and deflection are both given; keep one of them");
  if (s.deflection) require("deflection", *s.deflection, 0, 0.3 * s.tyre.diameter, "m");
  if (s.load_index) require("load index", *s.load_index, 0, 200, "");
  if (s.tread_width) require("tread width", *s.tread_width, 0.05 * s.tyre.diameter, 1.2 * s.tyre.section_width, "m");
  if (s.lug_height) require("lug height", *s.lug_height, 0, 0.2 * s.tyre.diameter, "m");
  if (s.lug_count) require("lug count", *s.lug_count, 0, 200, "");
  if (s.friction) require("friction", *s.friction, 0.05, 2, "");
  if (s.tractive_force) require("tractive force over weight", *s.tractive_force, 0.02, 5, "");
  if (s.driven_axles) require("driven axles", *s.driven_axles, 1, s.axles, "");
}

void place_axles(Complete& c) {
  const DataSheet& s = c.sheet;
  if (s.wheelbase.empty() || (s.wheelbase.size() != 1 && int(s.wheelbase.size()) != s.axles - 1))
    refuse("wheelbase: " + std::to_string(s.wheelbase.size()) + " distances are given for " + std::to_string(s.axles) +
           " axles; give the one between the outer axles, or " + std::to_string(s.axles - 1) + ", from the front");
  const bool even = s.axles > 2 && s.wheelbase.size() == 1;
  c.axle_x = {0};
  for (int a = 1; a < s.axles; ++a) {
    const double gap = even ? s.wheelbase[0] / (s.axles - 1) : s.wheelbase[std::size_t(a - 1)];
    const double least = s.tyre.diameter - 2 * s.lug_height.value_or(0);
    if (!(gap >= least && gap <= 20))
      refuse("wheelbase: axles " + std::to_string(a) + " and " + std::to_string(a + 1) + " are " + number_text(gap) +
             " m apart; with tyres of " + number_text(least) + " m allowed are that to 20 m");
    c.axle_x.push_back(c.axle_x.back() + gap);
  }
  if (even) c.assumed.push_back("axles: evenly spaced, because one wheelbase is given");
  if (s.track < s.tyre.section_width)
    refuse("track: left and right tyres of " + number_text(s.tyre.section_width) + " m overlap on a track of " +
           number_text(s.track) + " m; give the distance of their middle planes");
}

/// Loads by equal springs under a rigid vehicle, as statics.h has them: linear in x.
void share_loads(Complete& c) {
  double mean = 0, square = 0;
  for (const double x : c.axle_x) mean += x / c.sheet.axles;
  for (const double x : c.axle_x) square += (x - mean) * (x - mean);
  for (std::size_t a = 0; a < c.axle_x.size(); ++a) {
    const double share = 1.0 / c.sheet.axles + (c.centre_behind - mean) * (c.axle_x[a] - mean) / square;
    if (!(share > 0))
      refuse("centre of mass: " + number_text(c.centre_behind) + " m behind the front axle leaves no load on axle " +
             std::to_string(a + 1) + "; put it between the axles");
    c.load.push_back(share * c.weight() / 2);
  }
}

void check_tyres(Complete& c) {
  const DataSheet& s = c.sheet;
  if (!s.tyre.pneumatic()) return;
  const double most = *std::max_element(c.load.begin(), c.load.end()), full = largest_inflation(s.tyre);
  const double limit = s.load_index ? load_of_index(*s.load_index) * kGravity : load_limit(s.tyre, full);
  if (most > limit)
    refuse("mass: " + number_text(s.mass, 6) + " kg put " + number_text(most / 1e3) + " kN on a tyre, and " +
           s.tyre.text + " bears " + number_text(limit / 1e3) + " kN " +
           (s.load_index
                ? "by its load index"
                : "at " + number_text(full / 1e3) + " kPa by the load formula of the Tire and Rim Association") +
           "; check mass, axles and tyre size" + (s.load_index ? "" : ", or give the load index"));
  if (s.inflation && most > load_limit(s.tyre, *s.inflation))
    c.assumed.push_back(
        "inflation: " + number_text(*s.inflation / 1e3) + " kPa bear " +
        number_text(load_limit(s.tyre, *s.inflation) / 1e3) +
        " kN at road speeds by the load formula of the Tire and Rim Association, and the largest load is " +
        number_text(most / 1e3) + " kN: taken as let down for slow driving");
}

// Rules.

/// The value that is given, or else one that a rule says.
template <class Value, class Default>
Value or_rule(Complete& c, const std::optional<Value>& given, const Default& rule, const std::string& told) {
  if (given) return *given;
  c.assumed.push_back(told);
  return Value(rule);
}

void set_centre(Complete& c) {
  const DataSheet& s = c.sheet;
  const double height = s.track / 2 / kStability;
  c.centre_height = or_rule(c, s.centre_height, height,
                            line("centre of mass: %.3g m high, half of the track over a static stability factor of "
                                 "1.2, that of utility vehicles (TRB Special Report 265)",
                                 height));
  require("height of the centre of mass", c.centre_height, 0.02, 6, "m");
  c.centre_behind = or_rule(c, s.centre_behind, c.base() / 2, "centre of mass: half-way between the outer axles");
}

void set_tread(Complete& c) {
  const DataSheet& s = c.sheet;
  const bool tyre = s.tyre.pneumatic();
  const double width = tyre ? kTreadPerSection * s.tyre.section_width : s.tyre.section_width;
  c.tread_width = s.tread_width.value_or(width);
  if (!s.tread_width && tyre)
    c.assumed.push_back(line("tread: %.3g m wide, 0.8 of the section, as the HMMWV's (hmmwv.json)", width));
  const double lug = tyre ? kLugPerDiameter * s.tyre.diameter : 0;
  c.lug_height = or_rule(
      c, s.lug_height, lug,
      tyre ? line("lugs: %.3g mm high, 0.017 of the diameter, the 16 mm of a mud tread on a tyre of 37 in", 1e3 * lug)
           : std::string("lugs: none; give --lugs for grousers"));
  c.lug_count = s.lug_count.value_or(c.lug_height > 0 ? kLugCount : 0);
  c.lug_thickness = s.lug_thickness.value_or(kLugThickness * s.tyre.diameter);
  if (c.lug_height > 0 && !s.lug_count)
    c.assumed.push_back("lugs: 24 around the wheel, as of the benchmark wheel (hmmwv.json)");
  if (c.lug_height > 0 && !s.lug_thickness)
    c.assumed.push_back(
        line("lugs: %.3g mm thick, 0.03 of the diameter, as of the benchmark wheel", 1e3 * c.lug_thickness));
  c.tread_radius = s.tyre.diameter / 2 - c.lug_height;
  c.friction = or_rule(c, s.friction, tyre ? kFrictionOfRubber : kFrictionOfMetal,
                       tyre ? "friction on hard ground: 0.8, of rubber on dry ground"
                            : "friction on hard ground: 0.5, of a metal wheel");
}

void set_deflection(Complete& c) {
  const DataSheet& s = c.sheet;
  if (s.inflation) {
    c.deflection = c.mean_load() / radial_stiffness(s.tyre, *s.inflation);
    c.assumed.push_back(
        line("deflection: %.3g mm under the mean load, by Rhyne's stiffness of belted radial tyres (Tire Science and "
             "Technology 33, 2005) at %.3g kPa",
             1e3 * c.deflection, *s.inflation / 1e3));
    require("deflection at this inflation", c.deflection, 0, 0.5 * s.tyre.section_height(), "m");
    return;
  }
  const double soft = s.tyre.pneumatic() ? kSoftDeflection * s.tyre.section_height() : 0;
  c.deflection = or_rule(c, s.deflection, soft,
                         s.tyre.pneumatic() ? line("deflection: %.3g mm, 15 %% of the section height, the off-road "
                                                   "value of mobility indices (Priddy & Willoughby 2006)",
                                                   1e3 * soft)
                                            : std::string("deflection: none, a rigid wheel"));
}

void set_masses(Complete& c) {
  const DataSheet& s = c.sheet;
  const double wheel = kWheelDensity * s.tyre.diameter * s.tyre.diameter * s.tyre.section_width;
  c.wheel_mass = std::min(wheel, kMostWheelMass * s.mass / c.wheels());
  c.assumed.push_back(
      line("wheels: %.3g kg each, 250 kg/m3 of diameter squared times width as the HMMWV's, at most a quarter of the "
           "vehicle together",
           c.wheel_mass));
  c.arm_mass = c.sprung() ? (kUpperArm + kLowerArm + kUpright) * s.mass / c.wheels() : 0;
  c.assumed.push_back(
      "moments of inertia: radii of gyration of 0.33 of the width, 0.26 and 0.286 of the length, as the HMMWV's");
}

void set_build(Complete& c) {
  const DataSheet& s = c.sheet;
  const bool large = s.tyre.pneumatic() && s.mass >= kSprungFrom;
  c.build = or_rule(c, s.build, large ? Build::sprung : Build::rigid,
                    large ? "suspension: wishbones with a ride frequency of 1.5 Hz (Gillespie, Fundamentals of Vehicle "
                            "Dynamics, 1992, ch. 5) and damping of 0.3"
                          : "suspension: none, as of robots; vehicles on tyres from 300 kg on get wishbones");
  c.drive = or_rule(
      c, s.drive, large ? Power::engine : Power::wheel_motors,
      large ? line("driveline: the power at every speed behind an efficiency of 0.85, %s differentials",
                   s.differential.c_str())
            : std::string("driveline: a motor in every driven wheel, with its share of the power at every speed"));
  c.driven_axles = or_rule(c, s.driven_axles, s.axles, "driven axles: all");
  c.tractive_force = or_rule(c, s.tractive_force, kTractivePerWeight,
                             "largest tractive force: the weight, enough to spin all wheels on dry hard ground");
  if (c.drive == Power::engine)
    c.assumed.push_back(line(
        "driver: full throttle when %.2g m/s too slow, 0.2 sqrt(g D), and as much again every %.2g s, 4 sqrt(D / g)",
        c.full_throttle_error(), c.integral_time()));
}

Complete complete(const DataSheet& sheet) {
  check_sheet(sheet);
  Complete c;
  c.sheet = sheet;
  place_axles(c);
  set_build(c);
  set_centre(c);
  share_loads(c);
  set_tread(c);
  set_deflection(c);
  check_tyres(c);
  set_masses(c);
  return c;
}

// The file.

Json part(double mass, double x, double y, double z) {
  Json p = Json::object();
  p["mass_kg"] = tidy(mass);
  p["inertia_kg_m2"] = vector(tidy(x), tidy(y), tidy(z));
  return p;
}

Json chassis(const Complete& c, double height, double ahead) {
  const double length = c.base() + 1.1 * c.diameter(), width = c.sheet.track + c.sheet.tyre.section_width;
  const double mass = c.sheet.mass - c.wheels() * (c.wheel_mass + c.arm_mass);
  const auto moment = [&](double radius) { return mass * radius * radius; };
  Json j = part(mass, moment(kRoll * width), moment(kPitch * length), moment(kYaw * length));
  j["centre_m"] = vector(tidy(ahead), 0, tidy(height));
  j["length_m"] = tidy(length);
  j["width_m"] = tidy(width);
  j["clearance_m"] = c.sheet.clearance;
  return j;
}

/// Parallel arms: the wheel moves straight up, and strut and wheel in the ratio kStrutPlace.
constexpr double kStrutPlace = 0.7;  // of the lower arm, from its pivot
/// Longest arm and tie rod, over the diameter: in the narrowest bed that repeats, 0.8 diameters, a rod has to be
/// shorter than half of the period.
constexpr double kLongestArm = 0.38;

Json sprung_axle(const Complete& c, double load) {
  const double d = c.diameter(), y = c.sheet.track / 2, ball = std::max(0.6 * y, y - 0.6 * c.tread_width - 0.05 * d);
  const double inner = std::max(0.5 * ball, ball - kLongestArm * d), reach = ball - inner;
  const double z = 0.12 * d, strut_y = inner + kStrutPlace * reach, strut = 0.5 * d;
  const double corner = c.sheet.mass / c.wheels();
  const double sprung =
      load / c.sheet.gravity - c.wheel_mass - kUpright * corner - 0.5 * (kUpperArm + kLowerArm) * corner;
  const double turns = 2 * kPi * c.sheet.ride_hz.value_or(kRideHz), ratio2 = kStrutPlace * kStrutPlace;
  const double mean = corner - c.wheel_mass - c.arm_mass, stiffness = mean * turns * turns / ratio2;
  const double push = sprung * c.sheet.gravity / kStrutPlace, damping = 2 * kRideDamping * mean * turns / ratio2;
  const double travel = 0.15 * d * kStrutPlace;
  Json points = Json::object();
  const auto at = [&](const char* name, double px, double py, double pz) {
    points[name] = vector(tidy(px), tidy(py), tidy(pz));
  };
  at("wheel", 0, y, 0);
  at("upright", 0, ball, 0);
  for (const auto& [arm, height] : {std::pair{"upper", z}, std::pair{"lower", -z}}) {
    const std::string name = arm;
    at((name + "_front").c_str(), 0.15 * d, inner, height);
    at((name + "_rear").c_str(), -0.15 * d, inner, height);
    at((name + "_ball").c_str(), 0, ball, height);
    at((name + "_centre").c_str(), 0, (inner + ball) / 2, height);
  }
  for (const char* name : {"spring", "damper"}) {
    at((std::string(name) + "_chassis").c_str(), 0, strut_y, -z + strut);
    at((std::string(name) + "_arm").c_str(), 0, strut_y, -z);
  }
  at("tie_rod_chassis", -0.15 * d, inner, 0);
  at("tie_rod_upright", -0.15 * d, ball, 0);
  const auto arm = [&](double share) {
    const double mass = share * corner, rod = mass * reach * reach / 12;
    return part(mass, rod, rod / 4, rod);
  };
  const double upright = kUpright * corner, block = upright * d * d / 100;
  Json j = Json::object();
  j["type"] = "double_wishbone";
  j["points_m"] = points;
  j["upper_arm"] = arm(kUpperArm);
  j["lower_arm"] = arm(kLowerArm);
  j["upright"] = part(upright, block, block, block);
  j["tie_rod"] = Json::Object{{"mass_kg", 0}};
  Json& spring = j["spring"] = Json::object();
  spring["free_length_m"] = tidy(strut + push / stiffness);
  spring["stiffness_N_m"] = tidy(stiffness);
  Json& stops = spring["stops"] = Json::object();
  stops["shortest_m"] = tidy(strut - travel);
  stops["longest_m"] = tidy(strut + travel);
  stops["pressed_m"] = numbers({0, tidy(travel / 4), tidy(travel / 2)});
  stops["force_N"] = numbers({0, tidy(push), tidy(5 * push)});
  j["damper"] =
      Json::Object{{"speed_m_s", numbers({-1, 0, 1})}, {"force_N", numbers({tidy(damping), 0, tidy(-damping)})}};
  return j;
}

Json rigid_axle(const Complete& c) {
  return Json::Object{{"type", "rigid"}, {"points_m", Json::Object{{"wheel", vector(0, c.sheet.track / 2, 0)}}}};
}

Json wheel(const Complete& c) {
  const double r = c.tread_radius, m = c.wheel_mass, across = m * (r * r / 2 + c.tread_width * c.tread_width / 12);
  Json own = part(m, 0.8 * across, 0.75 * m * r * r, 0.8 * across);
  Json named = Json::object();
  named["name"] = "wheel";
  for (const auto& [key, value] : own.members()) named[key] = value;
  Json j = Json::object();
  j["parts"] = Json::Array{named};
  j["radius_m"] = tidy(r);
  j["width_m"] = tidy(c.tread_width);
  j["friction"] = c.friction;
  if (c.lug_height > 0 && c.lug_count > 0)
    j["lugs"] =
        Json::Object{{"count", c.lug_count}, {"height_m", tidy(c.lug_height)}, {"thickness_m", tidy(c.lug_thickness)}};
  if (c.deflection > 0) {
    const double stiffness = c.mean_load() / c.deflection;
    j["compliant"] =
        Json::Object{{"stiffness_N_m", tidy(stiffness)},
                     {"damping_N_s_m", tidy(2 * kTyreDamping * std::sqrt(stiffness * c.sheet.mass / c.wheels()))}};
  }
  const TyreSize& t = c.sheet.tyre;
  if (!t.pneumatic()) return j;
  j["tyre_size"] = Json::Object{{"diameter_m", tidy(t.diameter)},
                                {"section_width_m", tidy(t.section_width)},
                                {"section_height_m", tidy(t.section_height())}};
  if (c.deflection > 0) j["tyre_size"]["deflection_m"] = tidy(std::min(c.deflection, t.section_height()));
  return j;
}

Json axles(const Complete& c) {
  Json list = Json::array();
  for (int a = 0; a < c.sheet.axles; ++a) {
    const std::string name = "axle " + std::to_string(a + 1);
    const bool steered = c.sprung() && a < (c.sheet.axles + 1) / 2 && c.sheet.axles != 3 ? true : c.sprung() && a == 0;
    Json j = Json::object();
    j["name"] = name;
    j["position_m"] = vector(tidy(c.base() / 2 - c.axle_x[std::size_t(a)]), 0, 0);
    j["suspension"] = c.sprung() ? name : "stiff";
    j["wheel"] = "wheel";
    if (a >= c.sheet.axles - c.driven_axles) j["driven"] = true;
    if (steered) j["steered"] = true;
    if (c.drive == Power::engine) {
      j["brake_torque_N_m"] = tidy(kBraking * c.load[std::size_t(a)] * c.tread_radius);
      if (c.sheet.differential == "locked") j["differential"] = "locked";
    }
    list.push_back(j);
  }
  return list;
}

/// Torque of all driven wheels over the speed of the tread: the largest, or the power over the speed [m/s], [N].
std::pair<std::vector<double>, std::vector<double>> tractive_curve(const Complete& c, double efficiency) {
  const double most = c.tractive_force * c.weight(), power = efficiency * c.sheet.power;
  const double corner = std::min(power / most, c.sheet.top_speed);
  std::vector<double> speed{0, corner}, force{most, most};
  constexpr int steps = 8;
  for (int i = 1; i <= steps && corner < c.sheet.top_speed; ++i) {
    speed.push_back(corner * std::pow(c.sheet.top_speed / corner, double(i) / steps));
    force.push_back(power / speed.back());
  }
  speed.push_back(kCutOff * c.sheet.top_speed);
  force.push_back(0);
  return {speed, force};
}

Json driveline(const Complete& c) {
  const bool engine = c.drive == Power::engine;
  const auto [speed, force] = tractive_curve(c, engine ? kEngineEfficiency : 1);
  const double top = c.sheet.top_speed / c.tread_radius, ratio = engine ? top / kEngineSpeed : 1;
  const double sharers = engine ? 1 : 2 * c.driven_axles;
  std::vector<double> turns, torque;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    turns.push_back(tidy(speed[i] / c.tread_radius / ratio));
    torque.push_back(tidy(force[i] * c.tread_radius * ratio / sharers));
  }
  if (turns[1] <= turns[0]) refuse("power: too little to move at all; check power and top speed");
  Json curve = Json::object();
  curve["speed_rad_s"] = numbers(turns);
  curve["torque_N_m"] = numbers(torque);
  curve["cut_speed_rad_s"] = turns.back();
  Json j = Json::object();
  j["type"] = engine ? "engine" : "wheel_motors";
  j["power_W"] = c.sheet.power;
  j[engine ? "engine" : "motor"] = curve;
  if (!engine) return j;
  j["gears_output_per_input"] = numbers({1});
  j["final_drive_output_per_input"] = tidy(ratio);
  j["centre_differential"] = c.sheet.differential == "locked" ? "locked" : "open";
  return j;
}

Json driver(const Complete& c) {
  Json j = Json::object();
  j["throttle_start_s"] = 0.25;
  j["throttle_ramp_s"] = 0.5;
  if (c.drive == Power::engine) {
    j["full_throttle_error_m_s"] = tidy(c.full_throttle_error());
    j["integral_time_s"] = tidy(c.integral_time());
  }
  if (!c.sprung()) return j;
  j["look_ahead_m"] = tidy(std::max(1.0, 1.5 * c.base()));
  j["steering_gain_rad_m"] = tidy(0.88 / c.base());  // the HMMWV's half of full lock per metre, over its wheelbase
  return j;
}

Json assembled(const Complete& c, double height, double ahead) {
  const DataSheet& s = c.sheet;
  Json j = Json::object();
  j["vehicle"] = s.name;
  j["kind"] = "wheeled";
  j["about"] =
      "Made by gonogo vehicle new from a data sheet. Origin in the middle between the outer axles, at their height.";
  j["sources"] = s.sources;
  j["unsourced"] = c.assumed;
  j["chassis"] = chassis(c, height, ahead);
  Json& suspensions = j["suspensions"] = Json::object();
  if (!c.sprung()) suspensions["stiff"] = rigid_axle(c);
  for (std::size_t a = 0; c.sprung() && a < c.load.size(); ++a)
    suspensions["axle " + std::to_string(a + 1)] = sprung_axle(c, c.load[a]);
  j["wheels"] = Json::Object{{"wheel", wheel(c)}};
  j["axles"] = axles(c);
  if (c.sprung()) j["steering"] = Json::Object{{"max_angle_deg", kSteeringDegrees}};
  j["driveline"] = driveline(c);
  j["driver"] = driver(c);
  return j;
}

}  // namespace

VehicleFile vehicle_file(const DataSheet& sheet) {
  const Complete c = complete(sheet);
  const double height = c.centre_height - c.tread_radius, ahead = c.base() / 2 - c.centre_behind;
  // The chassis lies where it brings the whole vehicle's centre of mass to its place.
  const Vehicle first = read_vehicle(Config::parse(assembled(c, height, ahead).dump(), sheet.name));
  const Weights w = weigh(first);
  const double lever = w.total / first.chassis.mass;
  return {assembled(c, height + lever * (height - w.centre.z), ahead + lever * (ahead - w.centre.x)), c.assumed};
}

}  // namespace gonogo::vehicle
