#include "pipeline/lab/validate/drawbar.h"

#include <algorithm>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/report/figure/chart.h"
#include "vehicle/model/statics.h"
#include "vehicle/semi_empirical/bekker_wong.h"
#include "vehicle/semi_empirical/traction.h"

namespace gonogo::lab {
namespace {

/// Dry sand of the Land Locomotion Laboratory and LETE sand (Wong, Theory of Ground Vehicles, table of terrain values;
/// configs/soils); shear displacement K of sands, 10 to 25 mm there.
struct BekkerSand {
  double n, k_c, k_phi, cohesion;  // [N/m^(n+1)], [N/m^(n+2)], [Pa]
};
constexpr BekkerSand kSand[] = {{1.1, 0.99e3, 1528.43e3, 1040}, {0.793, 102e3, 5301e3, 1300}};
constexpr double kShear[] = {0.010, 0.025};
/// Cone index of dry sand at tyre depth, loose to dense [Pa]: 30 to 150 psi, the range in which Turnage's and Mason's
/// sand data lie.
constexpr double kConeIndex[] = {207e3, 414e3, 1034e3};

void widen(double (&range)[2], double x) {
  range[0] = std::min(range[0], x);
  range[1] = std::max(range[1], x);
}

void add_wong_reece(const WheelOnSand& w, double friction_angle, double cohesion, TractionBand& band) {
  for (const BekkerSand& sand : kSand)
    for (const double shear : kShear)
      for (const double c : {0.0, sand.cohesion, cohesion}) {
        const vehicle::BekkerSoil soil{.n = sand.n,
                                       .k_c = sand.k_c,
                                       .k_phi = sand.k_phi,
                                       .cohesion = c,
                                       .friction_angle = friction_angle * kDegree,
                                       .shear_modulus = shear};
        const vehicle::WheelForces f = vehicle::wheel_forces_under(soil, w.radius, w.width, band.slip, w.load);
        const double pull = f.drawbar_pull / w.load;
        widen(band.pull, pull);
        widen(band.resistance, f.torque / w.radius / w.load - pull);
      }
}

void add_cone_index(const WheelOnSand& w, TractionBand& band) {
  for (const double index : kConeIndex) {
    // Contact pressure of the mobility index: load over width times radius.
    const double ratio = w.load / (w.width * w.radius) / index;
    if (ratio < vehicle::kMinPressureRatio) continue;
    const double net = vehicle::sand_net_traction(ratio, band.slip);
    widen(band.pull, net);
    if (!(w.section_height > 0)) continue;
    const vehicle::WheelOnSoil on{.load = w.load,
                                  .diameter = 2 * w.radius,
                                  .width = w.width,
                                  .section_height = w.section_height,
                                  .deflection = w.deflection,
                                  .cone_index = index};
    widen(band.resistance, vehicle::sand_gross_traction(vehicle::sand_numeric(on), band.slip) - net);
  }
}

}  // namespace

TractionBand sand_band(const WheelOnSand& wheel, double friction_angle, double slip, double cohesion) {
  TractionBand band{slip, {1e9, -1e9}, {1e9, -1e9}};
  add_wong_reece(wheel, friction_angle, cohesion, band);
  add_cone_index(wheel, band);
  return band;
}

namespace {

/// A tyre under the mean load of the wheels. As for the mobility index, 15 % of the section's height is its deflection
/// where the file gives none.
WheelOnSand tyre_of(const vehicle::Vehicle& v) {
  const auto wheels = vehicle::stations(v);
  const vehicle::Wheel& w = *wheels.front().wheel;
  return {.radius = w.radius,
          .width = w.width,
          .load = vehicle::weigh(v).total * kGravity / double(wheels.size()),
          .section_height = w.size_section_height,
          .deflection = w.size_deflection > 0 ? w.size_deflection : 0.15 * w.size_section_height};
}

/// Sums over the seeds of one part of the sweep.
struct PartSum {
  std::vector<double> slip, pull, resistance, sinkage;
};

DrawbarPoint point_of(const PartSum& part, const vehicle::Vehicle& v, double shear_plane_angle) {
  DrawbarPoint p;
  p.slip = mean_error(part.slip).mean;
  p.pull = mean_error(part.pull);
  p.resistance = mean_error(part.resistance);
  p.sinkage = mean_error(part.sinkage).mean;
  p.band = sand_band(v, shear_plane_angle, p.slip);
  return p;
}

Json range(const double (&x)[2]) {
  Json pair = Json::array();
  pair.push_back(x[0]);
  pair.push_back(x[1]);
  return pair;
}

}  // namespace

TractionBand sand_band(const vehicle::Vehicle& v, double friction_angle, double slip) {
  return sand_band(tyre_of(v), friction_angle, slip);
}

DrawbarReport measure_drawbar(const DrawbarRequest& r) {
  campaign::TrialSetup setup = campaign::vehicle_trial_setup(
      r.vehicle, r.calibration, campaign::drawbar_task({.share = 1, .ramp = r.sweep}), r.numerics);
  setup.settled_on = r.batch.backend;
  if (vehicle::is_quarter(setup.vehicle)) throw InputError("a drawbar curve needs a whole vehicle");
  if (r.folded) campaign::fold_bed(setup);
  setup.compliant_tyres = r.compliant_tyres;
  setup.wheel_rolling = r.wheel_rolling;
  campaign::check_tyres(setup);
  const vehicle::Vehicle& v = setup.vehicle;
  const auto points = replicates(plain_variables(setup, 0, r.friction_angle, r.speed), r.seeds);
  std::vector<PartSum> part;
  double driven = 0;
  for (const vehicle::Station& s : vehicle::stations(v)) driven += s.driven;
  const double radius = tyre_of(v).radius, weight = setup.weight(0);
  for (const campaign::TrialRecord& record : run_trials(setup, points, r.batch)) {
    if (record.verdict == campaign::Verdict::unknown)
      throw DeviceError("a trial of the drawbar curve failed its checks");
    part.resize(std::max(part.size(), record.pull.size()));
    for (std::size_t k = 0; k < record.pull.size(); ++k) {
      const campaign::PullPoint& p = record.pull[k];
      part[k].slip.push_back(p.slip);
      part[k].pull.push_back(p.pull);
      part[k].sinkage.push_back(p.sinkage);
      part[k].resistance.push_back(driven * p.torque / radius / weight - p.pull);
    }
  }
  DrawbarReport report;
  report.vehicle = v.name;
  report.compliant_tyres = r.compliant_tyres;
  report.friction_angle = r.friction_angle;
  report.shear_plane_angle =
      terrain::on_shear_plane(setup.calibration, {r.friction_angle, 0, 0, kRelativeDensity}).friction_angle;
  report.grains_per_tyre = campaign::grains_per_tyre(setup);
  for (const PartSum& k : part)
    if (const double slip = mean_error(k.slip).mean; slip > 0.01 && slip < 0.95)
      report.point.push_back(point_of(k, v, report.shear_plane_angle));
  std::sort(report.point.begin(), report.point.end(),
            [](const DrawbarPoint& a, const DrawbarPoint& b) { return a.slip < b.slip; });
  for (int k = 1; k <= 19; ++k) report.band.push_back(sand_band(v, report.shear_plane_angle, 0.05 * k));
  return report;
}

namespace {

const char* tyres(const DrawbarReport& r) { return r.compliant_tyres ? "compliant" : "rigid"; }

}  // namespace

Json as_json(const DrawbarReport& r) {
  Json json;
  json["vehicle"] = r.vehicle;
  json["tyres"] = tyres(r);
  json["friction_angle_deg"] = r.friction_angle;
  json["shear_plane_angle_deg"] = r.shear_plane_angle;
  json["grains_per_tyre"] = r.grains_per_tyre;
  json["label"] = r.grains_per_tyre >= campaign::kGrainsPerTyre ? "fine" : "coarse";
  int pull = 0, resistance = 0;
  for (const DrawbarPoint& p : r.point) {
    Json one;
    one["slip"] = p.slip;
    one["sinkage_m"] = p.sinkage;
    one["pull_per_weight"] = p.pull.mean;
    one["pull_error"] = p.pull.error;
    one["pull_band"] = range(p.band.pull);
    one["resistance_per_weight"] = p.resistance.mean;
    one["resistance_error"] = p.resistance.error;
    one["resistance_band"] = range(p.band.resistance);
    json["points"].push_back(std::move(one));
    pull += p.pull_inside();
    resistance += p.resistance_inside();
  }
  json["drawbar_points"] = r.point.size();
  json["drawbar_inside"] = pull;
  json["resistance_inside"] = resistance;
  return json;
}

std::string as_text(const DrawbarReport& r) {
  std::string text = line(
      "%s on %s tyres on sand of %.1f degrees by triaxial compression, %.1f on the plane of shear, a tyre "
      "%.1f grains wide\n",
      r.vehicle.c_str(), tyres(r), r.friction_angle, r.shear_plane_angle, r.grains_per_tyre);
  text += "  slip  sinkage [mm]  pull/weight   band             resistance/weight  band\n";
  for (const DrawbarPoint& p : r.point) {
    text += line("%6.3f  %12.1f  %+.3f        %+.3f to %+.3f%s  %+.3f             %+.3f to %+.3f%s\n", p.slip,
                 1e3 * p.sinkage, p.pull.mean, p.band.pull[0], p.band.pull[1], p.pull_inside() ? " " : "!",
                 p.resistance.mean, p.band.resistance[0], p.band.resistance[1], p.resistance_inside() ? "" : "!");
  }
  return text + "  ! outside the band\n";
}

namespace {

report::LinePlot plot_of(const DrawbarReport& r) {
  report::LinePlot plot;
  plot.title = r.vehicle + ": drawbar pull and resistance on sand";
  plot.x_label = "slip";
  plot.y_label = "share of the weight";
  constexpr int kPullColour = 0, kResistanceColour = 3;
  report::PlotLine of_pull{.label = "pull, formulas", .colour = kPullColour};
  report::PlotLine of_resistance{.label = "resistance, formulas", .colour = kResistanceColour};
  for (const TractionBand& b : r.band) {
    of_pull.x.push_back(b.slip);
    of_resistance.x.push_back(b.slip);
    of_pull.y.push_back(b.pull[0]);
    of_pull.upper.push_back(b.pull[1]);
    of_resistance.y.push_back(b.resistance[0]);
    of_resistance.upper.push_back(b.resistance[1]);
  }
  report::PlotLine pull{.label = "pull, trials", .points = true, .colour = kPullColour};
  report::PlotLine resistance{.label = "resistance, trials", .points = true, .colour = kResistanceColour};
  for (const DrawbarPoint& p : r.point) {
    pull.add(p.slip, p.pull.mean);
    resistance.add(p.slip, p.resistance.mean);
  }
  plot.lines = {of_pull, of_resistance, pull, resistance};
  plot.notes.push_back(
      line("friction angle %.1f degrees, on the plane of shear %.1f, %s tyres %.1f grains wide; formulas: Wong and "
           "Reece on two sands, Mason et al. over cone indices",
           r.friction_angle, r.shear_plane_angle, tyres(r), r.grains_per_tyre));
  return plot;
}

}  // namespace

void write_drawbar(const std::filesystem::path& folder, const DrawbarReport& r) {
  create_folder(folder);
  std::string csv =
      "slip,sinkage_m,pull_per_weight,pull_min,pull_max,resistance_per_weight,resistance_min,resistance_max\n";
  for (const DrawbarPoint& p : r.point)
    csv += line("%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", p.slip, p.sinkage, p.pull.mean, p.band.pull[0],
                p.band.pull[1], p.resistance.mean, p.band.resistance[0], p.band.resistance[1]);
  write_file_atomically(folder / (r.vehicle + "_drawbar.csv"), csv);
  report::draw_line_plot(folder / (r.vehicle + "_drawbar.png"), plot_of(r));
}

}  // namespace gonogo::lab
