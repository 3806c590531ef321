#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/lab/soil/test_runs.h"
#include "terrain/soil_test/cone.h"
#include "terrain/soil_test/plate.h"

namespace gonogo::lab {
namespace {

void report_bekker(SoilTestOutcome& o, const terrain::BekkerFit& fit) {
  o.json["k_c_kN_per_m_n_plus_1"] = fit.k_c / 1e3;
  o.json["k_c_error"] = fit.k_c_error / 1e3;
  o.json["k_phi_kN_per_m_n_plus_2"] = fit.k_phi / 1e3;
  o.json["k_phi_error"] = fit.k_phi_error / 1e3;
  o.json["n"] = fit.n;
  o.json["n_error"] = fit.n_error;
  o.json["r2"] = fit.r2;
  o.text = line("Bekker: k_c %.2f +- %.2f kN/m^(n+1), k_phi %.0f +- %.0f kN/m^(n+2), n %.2f +- %.2f\n", fit.k_c / 1e3,
                fit.k_c_error / 1e3, fit.k_phi / 1e3, fit.k_phi_error / 1e3, fit.n, fit.n_error);
  o.plot.notes = {o.text.substr(0, o.text.size() - 1)};
}

/// One for each plate width.
std::vector<terrain::PlateSettings> plate_settings(const SoilTestRequest& r) {
  std::vector<terrain::PlateSettings> settings(r.plate_widths.size());
  for (std::size_t k = 0; k < settings.size(); ++k) {
    settings[k].width_grains = r.plate_widths[k];
    if (r.quick) {
      settings[k].bed_depth = 2;
      settings[k].growth_time = 3;
    }
    settings[k].steps_per_time = steps_per_gravity_time(settings[k].steps_per_time, r);
  }
  return settings;
}

/// Curves of all runs, the widths of one seed after those of another, and the fitted curve of each width.
void draw_plates(SoilTestOutcome& o, const std::vector<terrain::PlateResult>& results, std::size_t widths,
                 const terrain::BekkerFit& fit, std::uint64_t first_seed) {
  o.csv = "plate_width_m,seed,sinkage_m,pressure_Pa\n";
  o.plot.x_label = "sinkage [mm]";
  o.plot.y_label = "pressure [kPa]";
  for (std::size_t k = 0; k < results.size(); ++k) {
    report::PlotLine curve{k < widths ? line("b = %.0f mm", 1e3 * results[k].width) : "", {}, {}, true};
    report::PlotLine fitted{k < widths ? line("Bekker, %.0f mm", 1e3 * results[k].width) : "", {}, {}, false};
    curve.colour = fitted.colour = int(k % widths);
    for (const auto& s : results[k].curve) {
      o.csv +=
          line("%.4f,%zu,%.6f,%.2f\n", results[k].width, std::size_t(first_seed) + k / widths, s.sinkage, s.pressure);
      if (s.sinkage < 0) continue;
      curve.x.push_back(1e3 * s.sinkage);
      curve.y.push_back(s.pressure / 1e3);
      fitted.x.push_back(1e3 * s.sinkage);
      fitted.y.push_back((fit.k_c / results[k].width + fit.k_phi) * std::pow(s.sinkage, fit.n) / 1e3);
    }
    o.plot.lines.push_back(curve);
    if (k < widths) o.plot.lines.push_back(fitted);
  }
}

/// Mean of the beds over depth, and from the least to the most of them as a band.
void draw_cone(report::LinePlot& plot, const std::vector<terrain::ConeResult>& results) {
  plot.x_label = "depth of the cone's base [mm]";
  plot.y_label = "force over base area [kPa]";
  report::PlotLine band, mean;
  const std::vector<terrain::ConeSample> profile = mean_profile(results);
  for (std::size_t k = 0; k < profile.size(); ++k) {
    const auto [lowest, highest] = std::minmax_element(
        results.begin(), results.end(),
        [k](const auto& a, const auto& b) { return a.profile[k].pressure < b.profile[k].pressure; });
    band.x.push_back(1e3 * profile[k].depth);
    mean.x.push_back(1e3 * profile[k].depth);
    band.y.push_back(lowest->profile[k].pressure / 1e3);
    band.upper.push_back(highest->profile[k].pressure / 1e3);
    mean.y.push_back(profile[k].pressure / 1e3);
  }
  band.colour = mean.colour = 0;
  if (results.size() > 1) {
    band.label = "least to most";
    mean.label = line("mean of %zu beds", results.size());
    plot.lines.push_back(band);
  }
  plot.lines.push_back(mean);
}

void report_cone(SoilTestOutcome& o, const std::vector<terrain::ConeResult>& results, double depth_mm) {
  std::vector<double> index;
  double density = 0;
  for (const terrain::ConeResult& one : results) {
    index.push_back(one.index);
    density += one.bulk_density / double(results.size());
  }
  const MeanError ci = mean_error(index);
  const terrain::LineFit fit = fit_cone(results);
  o.json["cone_diameter_m"] = results[0].diameter;
  o.json["cone_index_kPa"] = ci.mean / 1e3;
  o.json["cone_index_error_kPa"] = ci.error / 1e3;
  o.json["gradient_MPa_per_m"] = fit.slope / 1e6;
  o.json["gradient_error_MPa_per_m"] = fit.slope_error / 1e6;
  o.json["r2"] = fit.r2;
  o.json["bulk_density_kg_per_m3"] = density;
  o.text =
      line("cone of %.0f mm: index %.1f +- %.1f kPa to a depth of %.0f mm, gradient %.3f +- %.3f MPa/m\n",
           1e3 * results[0].diameter, ci.mean / 1e3, ci.error / 1e3, depth_mm, fit.slope / 1e6, fit.slope_error / 1e6);
  o.plot.notes = {o.text.substr(0, o.text.size() - 1)};
}

}  // namespace

std::vector<terrain::PlateResult> run_plates(const SoilTestRequest& r, terrain::TestScene* scene) {
  if (r.plate_widths.size() < 2)
    throw InputError("soil test plate: two plate widths or more are needed for k_c and k_phi");
  const std::vector<terrain::PlateSettings> settings = plate_settings(r);
  Index steps = 0;
  for (const terrain::PlateSettings& s : settings) steps = std::max(steps, terrain::plate_steps(s));
  const std::size_t count = settings.size() * std::size_t(r.seeds);
  std::vector<terrain::PlateResult> results(count);
  Runs runs("plate", r, count, steps);
  runs([&](std::size_t k, const terrain::TestPace& pace) {
    results[k] = plate_test(seeded(r, k / settings.size()), settings[k % settings.size()], pace,
                            k + 1 == count ? scene : nullptr);
  });
  return results;
}

SoilTestOutcome plate(const SoilTestRequest& r) {
  SoilTestOutcome o = begin("plate", r);
  const std::vector<terrain::PlateResult> results = run_plates(r, &o.scene);
  const terrain::BekkerFit fit = fit_bekker(results);
  draw_plates(o, results, r.plate_widths.size(), fit, r.soil.seed);
  report_bekker(o, fit);
  double worst = 0;
  for (const terrain::PlateResult& result : results) worst = std::max(worst, result.worst_residual);
  finish(o, worst);
  return o;
}

SoilTestOutcome cone(const SoilTestRequest& r) {
  terrain::ConeSettings settings;
  settings.diameter_grains = r.cone_diameter;
  if (r.quick) settings.speed = 0.2;
  settings.steps_per_time = steps_per_gravity_time(settings.steps_per_time, r);
  std::vector<terrain::ConeResult> results(std::size_t(r.seeds));
  SoilTestOutcome o = begin("cone", r);
  Runs runs("cone", r, results.size(), terrain::cone_steps(settings));
  runs([&](std::size_t k, const terrain::TestPace& pace) {
    results[k] = cone_test(seeded(r, k), settings, pace, k + 1 == results.size() ? &o.scene : nullptr);
  });
  o.csv = "cone_diameter_m,seed,depth_m,pressure_Pa\n";
  double worst = 0;
  for (std::size_t k = 0; k < results.size(); ++k) {
    worst = std::max(worst, results[k].worst_residual);
    for (const auto& s : results[k].curve)
      o.csv += line("%.4f,%zu,%.6f,%.2f\n", results[k].diameter, std::size_t(r.soil.seed) + k, s.depth, s.pressure);
  }
  draw_cone(o.plot, results);
  report_cone(o, results, 1e3 * settings.depth * results[0].diameter);
  finish(o, worst);
  return o;
}

}  // namespace gonogo::lab
