// Suspensions and wheels.
#include <cmath>

#include "base/format.h"

#include "vehicle/model/read.h"

namespace gonogo::vehicle {
namespace {

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

}  // namespace

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

TyreSpring read_tyre_spring(const Config& wheel) {
  const auto c = wheel.object_if("compliant");
  if (!c) return {};
  const TyreSpring tyre{c->number("stiffness_N_m", {1, 1e9}), c->number("damping_N_s_m", {0, 1e8})};
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

}  // namespace gonogo::vehicle
