// Driveline and track.
#include "base/format.h"
#include "vehicle/model/read.h"

namespace gonogo::vehicle {
namespace {

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

}  // namespace

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
  if (const auto belt = c.object_if("belt")) t.belt.push_back(read_belt(*belt, t));
  c.finish();
  return t;
}

}  // namespace gonogo::vehicle
