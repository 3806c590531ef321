#include "pipeline/lab/vehicle/vci.h"

#include "base/units.h"
#include "vehicle/model/statics.h"
#include "vehicle/semi_empirical/mobility_index.h"
#include "vehicle/semi_empirical/traction.h"

namespace gonogo::lab {
namespace {

using namespace vehicle;

constexpr double kSlip = 0.2;  // of the traction columns

void factors(const VehicleIndex& index, bool wheels, Report& r) {
  const MobilityFactors& f = index.factors;
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
WheelOnSoil mean_wheel(const Vehicle& v, const VehicleIndex& index) {
  const auto places = stations(v);
  const Wheel& wheel = *places[0].wheel;
  return {.load = weigh(v).total * kGravity / double(places.size()),
          .diameter = wheel.size_diameter,
          .width = wheel.size_section_width,
          .section_height = wheel.size_section_height,
          .deflection = index.deflection_ratio * wheel.size_section_height};
}

void tractions(const WheelOnSoil& w, Report& r, Json& row) {
  const double ratio = w.load / (w.width * w.diameter / 2) / w.cone_index;
  const double clay = clay_traction(w, kSlip).net(), bias = brixius(w, kSlip, false).net(),
               radial = brixius(w, kSlip, true).net();
  const bool soft = ratio >= kMinPressureRatio;
  const double sand = soft ? sand_net_traction(ratio, kSlip) : 0;
  r.text += line(" %6.2f %13.2f %15.2f %10s", clay, bias, radial, soft ? line("%.2f", sand).c_str() : "too firm");
  row["net_traction_clay"] = clay;
  row["net_traction_brixius_bias"] = bias;
  row["net_traction_brixius_radial"] = radial;
  row["net_traction_sand"] = soft ? Json(sand) : Json(nullptr);
}

/// Passes, and traction of wheels, over the cone index.
void strengths(const Vehicle& v, const VehicleIndex& index, Report& r) {
  const bool wheels = v.kind != VehicleKind::tracked;
  WheelOnSoil w;
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
    Json row;
    row["cone_index_psi"] = psi;
    row["passes"] = passes;
    w.cone_index = psi * kPsi;
    if (wheels) tractions(w, r, row);
    r.text += "\n";
    rows.push_back(row);
  }
  r.json["strengths"] = rows;
}

}  // namespace

Report vehicle_cone_index(const Vehicle& v) {
  const VehicleIndex index = vehicle_index(v);
  Report r;
  const double mass = weigh(v).total;
  r.json["vehicle"] = v.name;
  r.json["total_mass_kg"] = mass;
  r.text = line("%s, %.0f kg (%.0f lb)%s%s\n", v.name.c_str(), mass, mass * 2.20462262,
                index.axle.empty() ? "" : ", axle ", index.axle.c_str());
  factors(index, v.kind != VehicleKind::tracked, r);
  const double mobility = index.factors.index();
  const VehicleConeIndex& c = index.cone_index;
  r.text += line("mobility index             %8.1f\n", mobility);
  if (v.kind != VehicleKind::tracked)
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

}  // namespace gonogo::lab
