#include "pipeline/lab/vehicle/show.h"

#include <cstdio>

#include "base/units.h"
#include "vehicle/model/belt.h"
#include "vehicle/model/statics.h"

namespace gonogo::lab {
namespace {

using namespace vehicle;

void masses(const Vehicle& v, Report& r) {
  const Weights w = weigh(v);
  const double height = w.centre.z - w.ground;
  r.json["total_mass_kg"] = w.total;
  r.json["unsprung_mass_kg"] = w.unsprung;
  r.json["centre_of_mass_m"] = Json::Array{w.centre.x, w.centre.y, height};
  r.text += line("mass                %10.1f kg, of it unsprung %.1f kg\n", w.total, w.unsprung);
  r.text += line("centre of mass      %10.3f m forward of the origin, %.3f m left, %.3f m above the ground\n",
                 w.centre.x, w.centre.y, height);
  r.text += line("ground clearance    %10.3f m\n", v.clearance);
}

void wheels(const Vehicle& v, Report& r) {
  const auto places = stations(v);
  const auto load = static_loads(v), pressure = contact_pressures(v);
  r.text += "\nwheel                     x [m]    y [m]  radius [m]  load [N]  nominal pressure [kPa]   [psi]\n";
  Json rows = Json::array();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Station& s = places[i];
    r.text += line("%-22s %8.3f %8.3f %11.3f %9.0f %23.1f %7.1f\n", s.name.c_str(), s.centre.x, s.centre.y,
                   s.wheel->radius, load[i], pressure[i] / 1e3, pressure[i] / kPsi);
    Json row;
    row["wheel"] = s.name;
    row["x_m"] = s.centre.x;
    row["y_m"] = s.centre.y;
    row["radius_m"] = s.wheel->radius;
    row["static_load_N"] = load[i];
    row["nominal_pressure_kPa"] = pressure[i] / 1e3;
    rows.push_back(row);
  }
  r.json["wheels"] = rows;
}

void belt(const Vehicle& v, Report& r) {
  const Track& t = v.track[0];
  r.json["track_ground_length_m"] = track_contact_length(v);
  r.json["belt_m"] = belt_length(v, true, 0);
  r.text +=
      line("\ntracks              %d and %d shoes of %.3f m: %.3f and %.3f m; way around the wheels %.3f to %.3f m\n",
           t.left_shoes, t.right_shoes, t.shoe_pitch, t.left_shoes * t.shoe_pitch, t.right_shoes * t.shoe_pitch,
           belt_length(v, true, 0), belt_length(v, true, 1));
  r.text += line("on the ground       %10.3f m of %.3f m wide shoes\n", track_contact_length(v), t.shoe_width);
}

void gears(const Vehicle& v, Report& r) {
  const double weight = weigh(v).total * kGravity;
  const bool motors = v.driveline.wheel_motors;
  r.text += line("\n%s  ratio  speed at the cut [m/s]  no torque left [m/s]  tractive force [kN]  over weight\n",
                 motors ? "motor" : "gear ");
  Json rows = Json::array();
  int number = 0;
  for (const GearSpeed& g : gear_speeds(v)) {
    r.text += line("%5d %6.2f %23.2f %21.2f %20.2f %12.2f\n", ++number, g.ratio, g.cut, g.balanced,
                   g.tractive_force / 1e3, g.tractive_force / weight);
    Json row;
    row["ratio"] = g.ratio;
    row["top_speed_m_s"] = g.cut;
    row["balanced_speed_m_s"] = g.balanced;
    row["tractive_force_N"] = g.tractive_force;
    rows.push_back(row);
  }
  r.json["gears"] = rows;
}

void notes(const Vehicle& v, Report& r) {
  r.text += "\nsources\n";
  for (const std::string& s : v.sources) r.text += "  " + s + "\n";
  if (!v.unsourced.empty()) r.text += "not from a source\n";
  for (const std::string& s : v.unsourced) r.text += "  " + s + "\n";
  r.json["sources"] = v.sources;
  r.json["unsourced"] = v.unsourced;
}

}  // namespace

Report show_vehicle(const Vehicle& v) {
  Report r;
  r.json["vehicle"] = v.name;
  r.text = v.name + ": " + v.about + "\n\n";
  masses(v, r);
  wheels(v, r);
  if (v.kind == VehicleKind::tracked) belt(v, r);
  gears(v, r);
  notes(v, r);
  return r;
}

}  // namespace gonogo::lab
