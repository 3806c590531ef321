#include "pipeline/inspect/vehicle_report.h"

#include "base/files/shipped.h"
#include "base/units.h"
#include "vehicle/model/statics.h"
#include "vehicle/model/track_loop.h"
#include "vehicle/semi_empirical/mobility_index.h"
#include "vehicle/semi_empirical/traction.h"

namespace gonogo::inspect {
namespace {

void masses(const vehicle::Vehicle& v, Report& r) {
  const vehicle::Weights w = weigh(v);
  const double height = w.centre.z - w.ground;
  r.json["total_mass_kg"] = w.total;
  r.json["unsprung_mass_kg"] = w.unsprung;
  r.json["centre_of_mass_m"] = Json::Array{w.centre.x, w.centre.y, height};
  r.text += line("mass                %10.1f kg, of it unsprung %.1f kg\n", w.total, w.unsprung);
  r.text += line("centre of mass      %10.3f m forward of the origin, %.3f m left, %.3f m above the ground\n",
                 w.centre.x, w.centre.y, height);
  r.text += line("ground clearance    %10.3f m\n", v.clearance);
}

void wheels(const vehicle::Vehicle& v, Report& r) {
  const auto places = stations(v);
  const auto load = static_loads(v), pressure = contact_pressures(v);
  r.text += "\nwheel                     x [m]    y [m]  radius [m]  load [N]  nominal pressure [kPa]   [psi]\n";
  Json rows = Json::array();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const vehicle::Station& s = places[i];
    r.text += line("%-22s %8.3f %8.3f %11.3f %9.0f %23.1f %7.1f\n", s.name.c_str(), s.centre.x, s.centre.y,
                   s.wheel->radius, load[i], pressure[i] / 1e3, pressure[i] / kPsi);
    rows.push_back(Json::Object{{"wheel", s.name},
                                {"x_m", s.centre.x},
                                {"y_m", s.centre.y},
                                {"radius_m", s.wheel->radius},
                                {"static_load_N", load[i]},
                                {"nominal_pressure_kPa", pressure[i] / 1e3}});
  }
  r.json["wheels"] = rows;
}

void belt(const vehicle::Vehicle& v, Report& r) {
  const vehicle::Track& t = *v.track;
  r.json["track_ground_length_m"] = track_contact_length(v);
  r.json["belt_m"] = belt_length(v, true, 0);
  r.text +=
      line("\ntracks              %d and %d shoes of %.3f m: %.3f and %.3f m; way around the wheels %.3f to %.3f m\n",
           t.left_shoes, t.right_shoes, t.shoe_pitch, t.left_shoes * t.shoe_pitch, t.right_shoes * t.shoe_pitch,
           belt_length(v, true, 0), belt_length(v, true, 1));
  r.text += line("on the ground       %10.3f m of %.3f m wide shoes\n", track_contact_length(v), t.shoe_width);
}

void gears(const vehicle::Vehicle& v, Report& r) {
  const double weight = weigh(v).total * kGravity;
  const bool motors = v.driveline.wheel_motors;
  r.text += line("\n%s  ratio  speed at the cut [m/s]  no torque left [m/s]  tractive force [kN]  over weight\n",
                 motors ? "motor" : "gear ");
  Json rows = Json::array();
  int number = 0;
  for (const vehicle::GearSpeed& g : gear_speeds(v)) {
    r.text += line("%5d %6.2f %23.2f %21.2f %20.2f %12.2f\n", ++number, g.ratio, g.cut, g.balanced,
                   g.tractive_force / 1e3, g.tractive_force / weight);
    rows.push_back(Json::Object{{"ratio", g.ratio},
                                {"top_speed_m_s", g.cut},
                                {"balanced_speed_m_s", g.balanced},
                                {"tractive_force_N", g.tractive_force}});
  }
  r.json["gears"] = rows;
}

void notes(const vehicle::Vehicle& v, Report& r) {
  r.text += "\nsources\n";
  for (const std::string& s : v.sources) r.text += "  " + s + "\n";
  if (!v.unsourced.empty()) r.text += "not from a source\n";
  for (const std::string& s : v.unsourced) r.text += "  " + s + "\n";
  r.json["sources"] = v.sources;
  r.json["unsourced"] = v.unsourced;
}

}  // namespace

Report show_vehicle(const vehicle::Vehicle& v) {
  Report r;
  r.json["vehicle"] = v.name;
  r.text = v.name + ": " + v.about + "\n\n";
  masses(v, r);
  wheels(v, r);
  if (v.kind == vehicle::VehicleKind::tracked) belt(v, r);
  gears(v, r);
  notes(v, r);
  return r;
}

namespace {

constexpr double kSlip = 0.2;  // of the traction columns

void factors(const vehicle::VehicleIndex& index, bool wheels, Report& r) {
  const vehicle::MobilityFactors& f = index.factors;
  const struct {
    const char *name, *key;
    double value;
  } rows[] = {{"contact pressure factor", "contact_pressure_factor", f.contact_pressure},
              {"weight factor", "weight_factor", f.weight},
              {wheels ? "tyre factor" : "track factor", wheels ? "tyre_factor" : "track_factor", f.tyre_or_track},
              {wheels ? "chain factor" : "grouser factor", "grouser_factor", f.grouser},
              {wheels ? "wheel load factor" : "bogie factor", wheels ? "wheel_load_factor" : "bogie_factor", f.load},
              {"clearance factor", "clearance_factor", f.clearance},
              {"engine factor", "engine_factor", f.engine},
              {"transmission factor", "transmission_factor", f.transmission}};
  for (const auto& row : rows) {
    r.text += line("%-26s %8.3f\n", row.name, row.value);
    r.json[row.key] = row.value;
  }
}

/// The mean wheel at its deflection; its soil is still to come.
vehicle::WheelOnSoil mean_wheel(const vehicle::Vehicle& v, const vehicle::VehicleIndex& index) {
  const auto places = stations(v);
  const vehicle::Wheel& wheel = *places[0].wheel;
  return {.load = weigh(v).total * kGravity / double(places.size()),
          .diameter = wheel.size_diameter,
          .width = wheel.size_section_width,
          .section_height = wheel.size_section_height,
          .deflection = index.deflection_ratio * wheel.size_section_height};
}

void tractions(const vehicle::WheelOnSoil& w, Report& r, Json& row) {
  const double ratio = w.load / (w.width * w.diameter / 2) / w.cone_index;
  const double clay = vehicle::clay_traction(w, kSlip).net(), bias = brixius(w, kSlip, false).net(),
               radial = brixius(w, kSlip, true).net();
  const bool soft = ratio >= vehicle::kMinPressureRatio;
  const double sand = soft ? vehicle::sand_net_traction(ratio, kSlip) : 0;
  r.text += line(" %6.2f %13.2f %15.2f %10s", clay, bias, radial, soft ? line("%.2f", sand).c_str() : "too firm");
  row["net_traction_clay"] = clay;
  row["net_traction_brixius_bias"] = bias;
  row["net_traction_brixius_radial"] = radial;
  row["net_traction_sand"] = soft ? Json(sand) : Json(nullptr);
}

/// Passes, and traction of wheels, over the cone index.
void strengths(const vehicle::Vehicle& v, const vehicle::VehicleIndex& index, Report& r) {
  const bool wheels = v.kind != vehicle::VehicleKind::tracked;
  vehicle::WheelOnSoil w;
  if (wheels) w = mean_wheel(v, index);
  if (wheels) r.text += line("\nnet traction over load at %.0f %% slip, mean wheel of %.0f N\n", 100 * kSlip, w.load);
  r.text += "cone index [psi]  [kPa]  passes in fine-grained soil";
  r.text += wheels ? "   clay  Brixius bias  Brixius radial   dry sand\n" : "\n";
  Json rows = Json::array();
  for (const double psi : {10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 80.0, 100.0, 150.0, 200.0, 300.0}) {
    const char* passes = psi < index.cone_index.one_pass       ? "none"
                         : psi < index.cone_index.fifty_passes ? "1 or more"
                                                               : "50";
    r.text += line("%16.0f %6.0f  %26s", psi, psi * kPsi / 1e3, passes);
    Json row = Json::Object{{"cone_index_psi", psi}, {"passes", passes}};
    w.cone_index = psi * kPsi;
    if (wheels) tractions(w, r, row);
    r.text += "\n";
    rows.push_back(row);
  }
  r.json["strengths"] = rows;
}

}  // namespace

Report vehicle_cone_index(const vehicle::Vehicle& v) {
  const vehicle::VehicleIndex index = vehicle_index(v);
  Report r;
  const double mass = weigh(v).total;
  r.json["vehicle"] = v.name;
  r.json["total_mass_kg"] = mass;
  r.text = line("%s, %.0f kg (%.0f lb)%s%s\n", v.name.c_str(), mass, mass * 2.20462262,
                index.axle.empty() ? "" : ", axle ", index.axle.c_str());
  factors(index, v.kind != vehicle::VehicleKind::tracked, r);
  const double mobility = index.factors.index();
  const vehicle::VehicleConeIndex& c = index.cone_index;
  r.text += line("mobility index             %8.1f\n", mobility);
  if (v.kind != vehicle::VehicleKind::tracked)
    r.text += line("tyre deflection            %8.1f %% of the section height%s\n", 100 * index.deflection_ratio,
                   index.deflection_given ? "" : " (not in the file: the usual one)");
  r.text += line("VCI1, one pass             %8.1f psi %8.1f kPa\n", c.one_pass, c.one_pass * kPsi / 1e3);
  r.text += line("VCI50, fifty passes        %8.1f psi %8.1f kPa\n", c.fifty_passes, c.fifty_passes * kPsi / 1e3);
  r.json["mobility_index"] = mobility;
  r.json["vci1_psi"] = c.one_pass;
  r.json["vci50_psi"] = c.fifty_passes;
  strengths(v, index, r);
  return r;
}

std::filesystem::path vehicle_file(const std::string& name) { return shipped_file("vehicles", "vehicle", name); }

}  // namespace gonogo::inspect
