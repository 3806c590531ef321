#include "vehicle/model/vehicle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "vehicle/model/track_loop.h"

namespace gonogo::vehicle {
namespace {

template <class Item>
const Item& by_name(const std::vector<Item>& items, const std::string& name) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == name; });
  GONOGO_ASSERT(found != items.end());
  return *found;
}

constexpr Range kMass{1e-3, 1e6}, kLength{1e-4, 100}, kForce{-1e8, 1e8};

/// Leading minors of the inertia matrix: all positive for a body that resists every rotation.
bool positive_definite(const Part& p) {
  const Vec3d &m = p.moments, &o = p.products;
  const double second = m.x * m.y - o.x * o.x;
  const double third = m.x * (m.y * m.z - o.z * o.z) - o.x * (o.x * m.z - o.z * o.y) + o.y * (o.x * o.z - m.y * o.y);
  return m.x > 0 && second > 0 && third > 0;
}

Vec3d read_vector(const Config& c, const std::string& key, Range range = {-100, 100}) {
  const auto n = c.numbers(key, range);
  if (n.size() != 3) c.fail(key, "needs 3 numbers [x, y, z], has " + std::to_string(n.size()));
  return {n[0], n[1], n[2]};
}

/// Two lists of equal length, the first ascending.
Curve read_curve(const Config& c, const std::string& at, const std::string& value, Range range = kForce) {
  Curve curve{c.numbers(at), c.numbers(value, range)};
  if (curve.at.size() < 2) c.fail(at, "needs at least 2 points");
  if (curve.at.size() != curve.value.size())
    c.fail(value, "has " + std::to_string(curve.value.size()) + " values for the " + std::to_string(curve.at.size()) +
                      " points of " + at);
  for (std::size_t i = 1; i < curve.at.size(); ++i)
    if (!(curve.at[i] > curve.at[i - 1])) c.fail(at + "[" + std::to_string(i) + "]", "must be above the one before it");
  return curve;
}

/// Reads "mass_kg", "centre_m" (when `placed`), "inertia_kg_m2", "products_kg_m2".
Part read_part(const Config& c, const std::string& name, bool placed) {
  Part p{.name = name, .mass = c.number("mass_kg", kMass)};
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

// Suspensions and wheels.

/// A given length of a rod or arm must be the distance of its ends: a loop that does not close is refused.
constexpr double kLoopError = 1e-3;  // [m]

const std::vector<std::string> kWishbonePoints{"wheel",          "upright",      "upper_front",     "upper_rear",
                                               "upper_ball",     "upper_centre", "lower_front",     "lower_rear",
                                               "lower_ball",     "lower_centre", "spring_chassis",  "spring_arm",
                                               "damper_chassis", "damper_arm",   "tie_rod_chassis", "tie_rod_upright"};

const std::vector<std::string>& points_of(SuspensionType type) {
  static const std::vector<std::string> arm{"wheel", "pivot", "arm_centre"}, wheel{"wheel"};
  if (type == SuspensionType::double_wishbone) return kWishbonePoints;
  return type == SuspensionType::trailing_arm ? arm : wheel;
}

SuspensionType type_of(const std::string& word) {
  if (word == "double_wishbone") return SuspensionType::double_wishbone;
  if (word == "trailing_arm") return SuspensionType::trailing_arm;
  return SuspensionType::rigid;
}

void read_stops(const Config& c, double& shortest, double& longest) {
  shortest = c.number("shortest_m", kLength);
  longest = c.number("longest_m", {shortest, 100});
}

Spring read_spring(const Config& c) {
  Spring s;
  if (c.has("stiffness_N_m")) {
    const double stiffness = c.number("stiffness_N_m", {0, 1e9}), free = c.number("free_length_m", kLength);
    const double reach = 10 * free, preload = c.number_or("preload_N", 0, {0, 1e7});
    s.force = {{free - reach, free + reach}, {stiffness * reach + preload, preload - stiffness * reach}};
  } else {
    s.force = read_curve(c, "length_m", "force_N");
    for (std::size_t i = 1; i < s.force.value.size(); ++i)
      if (s.force.value[i] > s.force.value[i - 1])
        c.fail("force_N[" + std::to_string(i) + "]", "a spring must not push harder when it is longer");
  }
  if (const auto stops = c.object_if("stops")) {
    read_stops(*stops, s.shortest, s.longest);
    s.stop = read_curve(*stops, "pressed_m", "force_N", {0, 1e8});
    stops->finish();
  }
  c.finish();
  return s;
}

/// No damper may drive the motion it damps.
Curve read_resistance(const Config& c) {
  Curve curve = read_curve(c, "speed_m_s", "force_N");
  for (std::size_t i = 0; i < curve.at.size(); ++i)
    if (curve.at[i] * curve.value[i] > 0)
      c.fail("force_N[" + std::to_string(i) + "]", "must be against the speed at which the ends part");
  return curve;
}

Damper read_damper(const Config& c) {
  Damper d;
  d.force = read_resistance(c);
  if (const auto bump = c.object_if("bump")) {
    read_stops(*bump, d.shortest, d.longest);
    d.bump = read_resistance(*bump);
    bump->finish();
  }
  c.finish();
  return d;
}

void read_part_at(const Config& c, const std::string& name, const Vec3d& centre, Suspension& s) {
  const Config section = c.object(name);
  Part part = read_part(section, name, false);
  section.finish();
  part.centre = centre;
  s.part[name] = part;
}

void read_wishbones(const Config& c, Suspension& s) {
  read_part_at(c, "upper_arm", s.point["upper_centre"], s);
  read_part_at(c, "lower_arm", s.point["lower_centre"], s);
  read_part_at(c, "upright", s.point["upright"], s);
  const Config rod = c.object("tie_rod");
  s.tie_rod_mass = rod.number("mass_kg", {0, 1e4});
  const double apart = length(s.point["tie_rod_chassis"] - s.point["tie_rod_upright"]);
  if (rod.has("length_m")) {
    const double given = rod.number("length_m", kLength);
    if (std::fabs(given - apart) > kLoopError)
      rod.fail("length_m", "the loop does not close: the rod is " + number_text(given, 5) + " m long, its ends are " +
                               number_text(apart, 5) + " m apart");
  }
  rod.finish();
  for (const char* arm : {"upper", "lower"}) {
    const std::string name = arm;
    const Vec3d front = s.point[name + "_front"], axis = s.point[name + "_rear"] - front;
    if (length(cross(axis, s.point[name + "_ball"] - front)) < 1e-6)
      c.fail("points_m." + name + "_ball", "lies on the arm's axis, so that the arm cannot hold the upright");
  }
}

Suspension read_suspension(const Config& c, const std::string& name) {
  Suspension s;
  s.name = name;
  s.type = type_of(c.choice("type", {"double_wishbone", "trailing_arm", "rigid"}));
  const Config points = c.object("points_m");
  for (const std::string& point : points_of(s.type)) s.point[point] = read_vector(points, point, {-20, 20});
  const bool damped_arm = s.type == SuspensionType::trailing_arm && points.has("damper_arm");
  if (damped_arm)
    for (const char* point : {"damper_chassis", "damper_arm"}) s.point[point] = read_vector(points, point, {-20, 20});
  points.finish();
  if (s.type == SuspensionType::double_wishbone) {
    read_wishbones(c, s);
    s.spring = read_spring(c.object("spring"));
  }
  if (s.type == SuspensionType::double_wishbone || damped_arm) s.damper = read_damper(c.object("damper"));
  if (s.type == SuspensionType::trailing_arm) {
    read_part_at(c, "arm", s.point["arm_centre"], s);
    const Config torsion = c.object("torsion");
    s.torsion = {torsion.number("stiffness_N_m_rad", {0, 1e9}), torsion.number("damping_N_m_s_rad", {0, 1e8}),
                 torsion.number("preload_N_m", {-1e8, 1e8})};
    torsion.finish();
  }
  c.finish();
  return s;
}

/// Reads "compliant" of a wheel, where it is there.
LinearSpring read_tyre_spring(const Config& wheel) {
  const auto c = wheel.object_if("compliant");
  if (!c) return {};
  const LinearSpring tyre{c->number("stiffness_N_m", {1, 1e9}), c->number("damping_N_s_m", {0, 1e8})};
  c->finish();
  return tyre;
}

Wheel read_wheel(const Config& c, const std::string& name) {
  Wheel w;
  w.name = name;
  w.part.name = name;
  for (const Config& section : c.objects("parts")) {
    const Part part = read_part(section, section.text("name"), false);
    section.finish();
    w.part.mass += part.mass;
    w.part.moments += part.moments;
  }
  if (w.part.mass <= 0) c.fail("parts", "a wheel needs at least one part with a mass");
  w.radius = c.number("radius_m", {0.01, 5});
  w.width = c.number("width_m", {0.005, 3});
  w.friction = c.number("friction", {0, 5});
  if (const auto lugs = c.object_if("lugs")) {
    w.lug_count = int(lugs->integer("count", {1, 200}));
    w.lug_height = lugs->number("height_m", {1e-4, 0.5});
    w.lug_thickness = lugs->number("thickness_m", {1e-4, 0.5});
    lugs->finish();
  }
  w.compliant = read_tyre_spring(c);
  if (const auto size = c.object_if("tyre_size")) {
    w.size_diameter = size->number("diameter_m", {0.02, 10});
    w.size_section_width = size->number("section_width_m", {0.005, 3});
    w.size_section_height = size->number("section_height_m", {0.001, 3});
    w.size_deflection = size->number_or("deflection_m", 0, {0, w.size_section_height});
    size->finish();
  }
  c.finish();
  return w;
}

// Driveline and track.

Part read_turning(const Config& c, const std::string& name, double& radius) {
  Part part = read_part(c, name, true);
  radius = c.number("radius_m", kLength);
  return part;
}

void read_shoe(const Config& c, Track& t) {
  t.shoe_mass = c.number("mass_kg", kMass);
  t.shoe_pitch = c.number("pitch_m", kLength);
  t.shoe_width = c.number("width_m", kLength);
  t.shoe_height = c.number("height_m", kLength);
  t.pad_above_pin = c.number("pad_above_pin_m", {0, 1});
  t.pad_below_pin = c.number("pad_below_pin_m", {0, 1});
  t.grouser_height = c.number_or("grouser_height_m", 0, {0, 1});
  t.left_shoes = int(c.integer("left_count", {3, 1000}));
  t.right_shoes = int(c.integer("right_count", {3, 1000}));
  c.finish();
}

Belt read_belt(const Config& c, const Track& t) {
  Belt b;
  b.shoe_inertia = read_vector(c, "shoe_inertia_kg_m2", {1e-9, 1e6});
  b.pin_radius = c.number("pin_radius_m", {1e-4, 0.25 * t.shoe_pitch});
  b.disc_distance = c.number("disc_distance_m", {1e-3, t.shoe_width});
  b.wheel_gap = c.number("wheel_gap_m", {1e-3, t.shoe_width});
  b.idler_width = c.number("idler_width_m", {b.wheel_gap, t.shoe_width});
  b.guide = read_vector(c, "guide_m", {1e-3, 1});
  if (t.grouser_height > 0) b.grouser_thickness = c.number("grouser_thickness_m", {1e-3, t.shoe_pitch});
  if (!(b.guide.y < b.wheel_gap))
    c.fail("guide_m", "is " + number_text(b.guide.y, 5) + " m wide and runs in a gap of " +
                          number_text(b.wheel_gap, 5) + " m; make it narrower than wheel_gap_m");
  const Config carrier = c.object("carrier"), tensioner = c.object("tensioner");
  b.carrier_mass = carrier.number("mass_kg", kMass);
  b.carrier_inertia = read_vector(carrier, "inertia_kg_m2", {1e-9, 1e9});
  carrier.finish();
  b.tensioner_force = tensioner.number("force_N", {0, 1e7});
  b.tensioner_stiffness = tensioner.number("stiffness_N_m", {1, 1e9});
  b.tensioner_damping = tensioner.number("damping_N_s_m", {0, 1e8});
  tensioner.finish();
  c.finish();
  return b;
}

void read_road_wheels(const Config& c, Track& t) {
  t.wheel = c.text("wheel");
  t.suspension_with_damper = c.text("suspension_with_damper");
  t.suspension = c.text("suspension");
  t.road_wheel_x = c.numbers("left_x_m", {-50, 50});
  t.right_road_wheel_x = c.numbers("right_x_m", {-50, 50});
  t.road_wheel_z = c.number("z_m", {-20, 20});
  if (t.road_wheel_x.size() < 2) c.fail("left_x_m", "a track needs at least 2 road wheels");
  if (t.road_wheel_x.size() != t.right_road_wheel_x.size())
    c.fail("right_x_m", "needs as many road wheels as the left");
  for (const double index : c.numbers("damped", {0, double(t.road_wheel_x.size() - 1)})) t.damped.push_back(int(index));
  c.finish();
}

void read_shifts(const Config& c, Driveline& d) {
  d.engine_inertia = c.number_or("engine_inertia_kg_m2", 0, {0, 1e4});
  d.idle_speed = c.number_or("idle_rad_s", 0, {0, 1e4});
  if ((d.clutch_torque > 0 || !d.converter_capacity.empty()) && !(d.engine_inertia > 0))
    c.fail("engine_inertia_kg_m2", "missing; an engine before a clutch or converter needs it");
  if (!c.has("upshift_rad_s")) return;
  d.up_speed = c.number("upshift_rad_s", {1e-3, 1e4});
  d.down_speed = c.number("downshift_rad_s", {0, d.up_speed});
  d.shift_time = c.number_or("shift_time_s", 0.5, {0, 100});
}

void read_engine(const Config& c, Driveline& d) {
  const Config engine = c.object("engine");
  d.engine = read_curve(engine, "speed_rad_s", "torque_N_m");
  d.cut_speed = engine.number("cut_speed_rad_s", {1e-3, 1e4});
  engine.finish();
  if (const auto converter = c.object_if("torque_converter")) {
    d.converter = read_curve(*converter, "speed_ratio", "torque_ratio", {0, 10});
    if (converter->has("capacity_N_m_s2"))
      d.converter_capacity = read_curve(*converter, "speed_ratio", "capacity_N_m_s2", {0, 1e3});
    converter->finish();
  }
  if (const auto clutch = c.object_if("clutch")) {
    d.clutch_torque = clutch->number("torque_N_m", {1e-3, 1e6});
    d.engaged_speed = clutch->number("engaged_at_rad_s", {1e-3, 1e4});
    clutch->finish();
    if (!d.converter.empty()) c.fail("clutch", "there is a torque converter too; give one of them");
  }
  read_shifts(c, d);
  d.gears = c.numbers("gears_output_per_input", {1e-3, 100});
  if (d.gears.empty()) c.fail("gears_output_per_input", "needs at least one gear");
  d.reverse = c.number_or("reverse_output_per_input", 0, {0, 100});
  d.final_drive = c.number("final_drive_output_per_input", {1e-3, 100});
  d.centre = read_differential(c, "centre_differential", d.centre_bias);
  d.front_share = c.number_or("front_share", 0.5, {0, 1});
}

Driveline read_driveline(const Config& c) {
  Driveline d;
  d.wheel_motors = c.choice("type", {"engine", "wheel_motors"}) == "wheel_motors";
  d.efficiency = c.number_or("efficiency", 1, {0.01, 1});
  if (d.wheel_motors) {
    const Config motor = c.object("motor");
    d.engine = read_curve(motor, "speed_rad_s", "torque_N_m");
    d.cut_speed = motor.number("cut_speed_rad_s", {1e-3, 1e4});
    motor.finish();
    d.gears = {1};
  } else {
    read_engine(c, d);
  }
  c.finish();
  return d;
}

Track read_track(const Config& c) {
  Track t;
  t.offset = c.number("offset_m", {0.01, 20});
  const Config sprocket = c.object("sprocket"), idler = c.object("idler");
  t.sprocket = read_turning(sprocket, "sprocket", t.sprocket_radius);
  sprocket.finish();
  t.idler = read_turning(idler, "idler", t.idler_radius);
  t.idler_travel = read_vector(idler, "tensioned_to_m");
  idler.finish();
  read_road_wheels(c.object("road_wheels"), t);
  read_shoe(c.object("shoe"), t);
  t.brake_torque = c.number("brake_torque_N_m", {0, 1e7});
  if (const auto belt = c.object_if("belt")) t.belt = read_belt(*belt, t);
  c.finish();
  return t;
}

// The rest of the file.

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

Driver read_driver(const Config& c) {
  Driver d;
  d.throttle_start = c.number_or("throttle_start_s", 0, {0, 1e4});
  d.throttle_ramp = c.number_or("throttle_ramp_s", 0, {0, 1e4});
  d.speed = c.number_or("speed_m_s", 0, {0, 100});
  d.full_throttle_error = c.number_or("full_throttle_error_m_s", d.full_throttle_error, {0.01, 100});
  d.integral_time = c.number_or("integral_time_s", d.integral_time, {0.01, 1e4});
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
    v.track = read_track(c.object("track"));
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

// Checks.

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

/// Throws for a track whose shoes are too few for its wheels, or too many for its tensioner.
void check_belt(const Config& c, const Vehicle& v) {
  const Track& t = *v.track;
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

/// What can only be judged across the sections of a file. `c` is the whole file.
void check_vehicle(const Config& c, const Vehicle& v) {
  if (v.kind == VehicleKind::tracked) {
    const Config wheels = c.object("track").object("road_wheels");
    require_known(wheels, "wheel", "wheel", v.wheel, v.track->wheel);
    require_known(wheels, "suspension_with_damper", "suspension", v.suspension, v.track->suspension_with_damper);
    require_known(wheels, "suspension", "suspension", v.suspension, v.track->suspension);
    check_belt(c, v);
  } else {
    check_axles(c, v);
  }
  check_springs(c, v);
}

/// The coefficient of friction that a tyre usually has; files of quarter vehicles name none.
constexpr double kUsualFriction = 0.8;

Wheel read_quarter_wheel(const Config& c, double hub_mass) {
  Wheel w;
  w.name = "wheel";
  w.part = {.name = w.name, .mass = hub_mass, .moments = {0, c.number("axle_moment_kg_m2", {1e-6, 1e5}), 0}};
  w.radius = c.number("radius_m", {0.01, 5});
  w.width = c.number("width_m", {0.005, 3});
  w.lug_count = int(c.integer_or("lug_count", 0, {0, 200}));
  w.lug_height = c.number_or("lug_height_m", 0, {0, 0.5});
  w.lug_thickness = c.number_or("lug_thickness_m", 0.03, {1e-3, 0.5});
  w.friction = kUsualFriction;
  w.compliant = read_tyre_spring(c);
  c.finish();
  return w;
}

}  // namespace

double Curve::operator()(double x) const {
  GONOGO_ASSERT(!at.empty());
  if (x <= at.front()) return value.front();
  if (x >= at.back()) return value.back();
  const std::size_t high = std::size_t(std::upper_bound(at.begin(), at.end(), x) - at.begin());
  const double share = (x - at[high - 1]) / (at[high] - at[high - 1]);
  return value[high - 1] + share * (value[high] - value[high - 1]);
}

double Spring::push(double length) const {
  double result = force.empty() ? 0 : force(length);
  if (stop.empty()) return result;
  if (length < shortest) result += stop(shortest - length);
  if (length > longest) result -= stop(length - longest);
  return result;
}

const Suspension& find_suspension(const Vehicle& v, const std::string& name) { return by_name(v.suspension, name); }
const Wheel& find_wheel(const Vehicle& v, const std::string& name) { return by_name(v.wheel, name); }

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

Vehicle quarter_vehicle(const std::string& name, Wheel wheel, const LinearSpring& spring, double sprung_mass,
                        double max_torque) {
  Vehicle v;
  v.name = name;
  v.kind = VehicleKind::quarter;
  v.chassis = {.name = "sprung mass", .mass = sprung_mass};
  Suspension strut;
  strut.name = "strut";
  strut.type = SuspensionType::guided;
  strut.point["wheel"] = {};
  strut.upright_spring = spring;
  v.axle.push_back({.name = wheel.name,
                    .suspension = strut.name,
                    .wheel = wheel.name,
                    .position = {},
                    .single = true,
                    .driven = true});
  v.suspension.push_back(std::move(strut));
  v.wheel.push_back(std::move(wheel));
  v.driveline.wheel_motors = true;
  v.driveline.engine = {{0}, {max_torque}};
  v.driveline.cut_speed = std::numeric_limits<double>::infinity();
  v.driveline.gears = {1};
  return v;
}

Vehicle read_quarter_vehicle(const std::filesystem::path& path) { return read_quarter_vehicle(Config::read(path)); }

Vehicle read_quarter_vehicle(const Config& c) {
  const std::string name = c.text("vehicle");
  c.choice("kind", {"quarter"});
  const std::string about = c.text_or("about", ""), sources = c.text_or("sources", "");
  const Config wheel = c.object("wheel");
  const double hub_mass = c.number("hub_mass_kg", {0.01, 1e5}), sprung_mass = c.number("sprung_mass_kg", {0.01, 1e6});
  const Config suspension = c.object("suspension"), drive = c.object("drive");
  const LinearSpring spring{suspension.number("stiffness_N_m", {1, 1e9}), suspension.number("damping_N_s_m", {0, 1e8})};
  suspension.finish();
  Vehicle v = quarter_vehicle(name, read_quarter_wheel(wheel, hub_mass), spring, sprung_mass,
                              drive.number("max_torque_N_m", {0.001, 1e7}));
  drive.finish();
  v.about = about;
  v.sources = {sources};
  v.payload_shares = int(c.integer("wheels_per_vehicle", {1, 100}));
  v.length = c.number("vehicle_length_m", {0.05, 50});
  v.clearance = c.number("ground_clearance_m", {0, 5});
  c.finish();
  return v;
}

Vehicle read_any_vehicle(const std::filesystem::path& path) { return read_any_vehicle(Config::read(path)); }

Vehicle read_any_vehicle(const Config& c) {
  return c.text("kind") == "quarter" ? read_quarter_vehicle(c) : read_vehicle(c);
}

}  // namespace gonogo::vehicle
