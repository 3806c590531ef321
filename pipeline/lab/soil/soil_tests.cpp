#include "pipeline/lab/soil/soil_tests.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/error.h"
#include "base/line.h"
#include "base/progress.h"
#include "terrain/soil_test/cone.h"
#include "terrain/soil_test/plate.h"
#include "terrain/soil_test/repose.h"
#include "terrain/soil_test/shear.h"
#include "terrain/soil_test/triaxial.h"

namespace gonogo::lab {
namespace {

using terrain::TestPace;
using terrain::TestScene;
using terrain::TestSoil;

/// Runs of one test side by side under one progress line.
class Runs {
 public:
  Runs(const std::string& test, const SoilTestRequest& request, std::size_t count, Index steps_each)
      : request_(request), count_(count), progress_("soil test " + test, "steps", count * std::size_t(steps_each)) {}

  /// job(k, pace) for each run.
  template <class Job>
  void operator()(Job job) {
    const int side_by_side = std::max(1, std::min(request_.threads, int(count_)));
    TestPace pace = request_.numerics ? terrain::pace_of(*request_.numerics) : TestPace{};
    pace.threads = std::max(1, request_.threads / side_by_side);
    pace.on_steps = [this](Index steps) {
      const std::lock_guard lock(mutex_);
      progress_.update(done_ += std::size_t(steps));
    };
    terrain::run_jobs(count_, side_by_side, [&](std::size_t k) { job(k, pace); });
    progress_.finish();
  }

 private:
  const SoilTestRequest& request_;
  std::size_t count_, done_ = 0;
  std::mutex mutex_;
  Progress progress_;
};

/// Steps in a test's unit of time: the test's own number, unless the step is that of trials.
double steps_per(double time, double own, const SoilTestRequest& r) {
  return r.numerics ? time / r.numerics->step : own;
}
double steps_per_gravity_time(double own, const SoilTestRequest& r) {
  return steps_per(terrain::gravity_time(r.soil.grain_diameter), own, r);
}
double steps_per_stress_time(double stress, double own, const SoilTestRequest& r) {
  return steps_per(terrain::stress_time(r.soil.grain_diameter, r.soil.grain_density, stress), own, r);
}

Json angle_json(const terrain::Angle& a) {
  Json j;
  j["deg"] = a.degrees;
  j["error_deg"] = a.error;
  return j;
}

/// What was tested, the same for all tests.
Json soil_json(const SoilTestRequest& r) {
  Json j;
  j["grain_diameter_m"] = r.soil.grain_diameter;
  j["shape"] = terrain::name_of(r.soil.shape);
  j["friction"] = double(r.soil.grain.friction);
  j["rolling_friction"] = double(r.soil.grain.rolling_friction);
  j["cohesion_pressure_Pa"] = double(r.soil.grain.cohesion_pressure);
  j["tool_friction"] = r.soil.tool_friction;
  j["relative_density"] = r.soil.relative_density;
  j["grain_density_kg_per_m3"] = r.soil.grain_density;
  j["seeds"] = r.seeds;
  j["first_seed"] = std::uint64_t(r.soil.seed);
  if (r.numerics) terrain::write_numerics(j["numerics"], *r.numerics);
  return j;
}

SoilTestOutcome begin(const std::string& test, const SoilTestRequest& r) {
  SoilTestOutcome o;
  o.json["test"] = test;
  o.json["soil"] = soil_json(r);
  o.plot.title = line("Virtual %s test: %ss of %g mm, friction %g, rolling %g", test.c_str(),
                      terrain::name_of(r.soil.shape).c_str(), 1e3 * r.soil.grain_diameter,
                      double(r.soil.grain.friction), double(r.soil.grain.rolling_friction));
  if (r.soil.grain.cohesion_pressure > 0)
    o.plot.title += line(", cohesion pressure %g kPa", double(r.soil.grain.cohesion_pressure) / 1e3);
  return o;
}

void finish(SoilTestOutcome& o, double worst_residual) {
  o.json["worst_rms_residual_m_per_s"] = worst_residual;
  o.text += line("worst residual of a step, rms: %.2e m/s\n", worst_residual);
}

TestSoil seeded(const SoilTestRequest& r, std::size_t k) {
  TestSoil soil = r.soil;
  soil.seed += k;
  return soil;
}

SoilTestOutcome repose(const SoilTestRequest& r) {
  terrain::ReposeSettings settings;
  if (r.quick) {
    settings.length = 16;
    settings.height = 8;
  }
  settings.steps_per_time = steps_per_gravity_time(settings.steps_per_time, r);
  std::vector<terrain::ReposeResult> results(std::size_t(r.seeds));
  SoilTestOutcome o = begin("repose", r);
  Runs runs("repose", r, results.size(), terrain::repose_steps(settings));
  runs([&](std::size_t k, const TestPace& pace) {
    results[k] = repose_test(seeded(r, k), settings, pace, k + 1 == results.size() ? &o.scene : nullptr);
  });
  o.csv = "seed,x_m,height_m\n";
  o.plot.x_label = "distance from the far wall [m]";
  o.plot.y_label = "height of the surface [m]";
  std::vector<double> angles;
  double worst = 0, rest = 0;
  for (std::size_t k = 0; k < results.size(); ++k) {
    angles.push_back(results[k].angle.degrees);
    worst = std::max(worst, results[k].worst_residual);
    rest = std::max(rest, results[k].rest_speed);
    report::PlotLine profile{line("seed %zu: %.1f deg", std::size_t(r.soil.seed) + k, angles.back()), {}, {}, false};
    for (const auto& s : results[k].profile) {
      o.csv += line("%zu,%.5f,%.5f\n", std::size_t(r.soil.seed) + k, s.x, s.height);
      profile.x.push_back(s.x);
      profile.y.push_back(s.height);
    }
    o.plot.lines.push_back(profile);
  }
  const terrain::MeanError mean = terrain::mean_error(angles);
  const double error = angles.size() > 1 ? mean.error : results[0].angle.error;
  o.json["angle_of_repose"] = angle_json({mean.mean, error});
  o.json["rest_speed_m_per_s"] = rest;
  o.text = line("angle of repose: %.1f +- %.1f deg\n", mean.mean, error);
  o.plot.notes = {line("Angle of repose %.1f +- %.1f degrees.", mean.mean, error)};
  finish(o, worst);
  return o;
}

/// Stress and seed of a run.
struct Load {
  double stress;
  std::size_t seed;
};
std::vector<Load> loads_of(const SoilTestRequest& r) {
  std::vector<Load> loads;
  for (const double stress : r.stresses)
    for (std::size_t s = 0; s < std::size_t(r.seeds); ++s) loads.push_back({stress, s});
  return loads;
}

void report_shear(SoilTestOutcome& o, const terrain::ShearStrength& s) {
  o.json["friction_angle"] = angle_json(s.steady_angle);
  o.json["cohesion_Pa"] = s.steady_cohesion;
  o.json["cohesion_error_Pa"] = s.steady_cohesion_error;
  o.json["r2"] = s.steady_r2;
  o.json["peak_friction_angle"] = angle_json(s.peak_angle);
  o.json["peak_cohesion_Pa"] = s.peak_cohesion;
  o.json["peak_cohesion_error_Pa"] = s.peak_cohesion_error;
  o.json["peak_r2"] = s.peak_r2;
  const std::string steady =
      line("steady: friction angle %.1f +- %.1f deg, cohesion %.0f +- %.0f Pa, R2 %.4f", s.steady_angle.degrees,
           s.steady_angle.error, s.steady_cohesion, s.steady_cohesion_error, s.steady_r2);
  const std::string peak =
      line("peak:   friction angle %.1f +- %.1f deg, cohesion %.0f +- %.0f Pa, R2 %.4f", s.peak_angle.degrees,
           s.peak_angle.error, s.peak_cohesion, s.peak_cohesion_error, s.peak_r2);
  o.text = steady + "\n" + peak + "\n";
  o.plot.notes = {steady, peak};
}

SoilTestOutcome shear(const SoilTestRequest& r) {
  const std::vector<Load> loads = loads_of(r);
  terrain::ShearSettings settings;
  if (r.quick) settings.travel = 2;
  std::vector<terrain::ShearResult> results(loads.size());
  SoilTestOutcome o = begin("shear", r);
  Runs runs("shear", r, loads.size(), terrain::shear_steps(settings));
  runs([&](std::size_t k, const TestPace& pace) {
    terrain::ShearSettings own = settings;
    own.normal_stress = loads[k].stress;
    own.steps_per_time = steps_per_stress_time(own.normal_stress, own.steps_per_time, r);
    const TestSoil soil = seeded(r, loads[k].seed);
    results[k] = shear_test(terrain::test_bed(soil, 10, 6, 8, pace.threads), soil.laws(), own, pace,
                            k + 1 == loads.size() ? &o.scene : nullptr);
  });
  o.csv = "normal_stress_Pa,seed,travel_grains,shear_stress_Pa,measured_normal_stress_Pa,rise_grains\n";
  o.plot.x_label = "travel of the plate, grain diameters";
  o.plot.y_label = "shear stress [kPa]";
  double worst = 0;
  for (std::size_t k = 0; k < loads.size(); ++k) {
    worst = std::max(worst, results[k].worst_residual);
    report::PlotLine curve{loads[k].seed == 0 ? line("%g kPa", loads[k].stress / 1e3) : "", {}, {}, false};
    for (const auto& s : results[k].curve) {
      o.csv += line("%g,%zu,%.4f,%.2f,%.2f,%.5f\n", loads[k].stress, std::size_t(r.soil.seed) + loads[k].seed, s.travel,
                    s.shear_stress, s.normal_stress, s.rise);
      curve.x.push_back(s.travel);
      curve.y.push_back(s.shear_stress / 1e3);
    }
    o.plot.lines.push_back(curve);
  }
  report_shear(o, terrain::shear_strength(results));
  finish(o, worst);
  return o;
}

SoilTestOutcome triaxial(const SoilTestRequest& r) {
  const std::vector<Load> loads = loads_of(r);
  terrain::TriaxialSettings settings;
  if (r.quick) {
    settings.grains_wide = 7;
    settings.grains_high = 12;
  }
  std::vector<terrain::TriaxialResult> results(loads.size());
  SoilTestOutcome o = begin("triaxial", r);
  Runs runs("triaxial", r, loads.size(), terrain::triaxial_steps(settings));
  runs([&](std::size_t k, const TestPace& pace) {
    terrain::TriaxialSettings own = settings;
    own.confining_stress = loads[k].stress;
    own.steps_per_time = steps_per_stress_time(own.confining_stress, own.steps_per_time, r);
    results[k] = triaxial_test(seeded(r, loads[k].seed), own, pace, k + 1 == loads.size() ? &o.scene : nullptr);
  });
  o.csv = "confining_stress_Pa,seed,strain,axial_stress_Pa,lateral_stress_Pa,volume_strain\n";
  o.plot.x_label = "axial strain";
  o.plot.y_label = "deviator stress over lateral stress";
  double worst = 0, fraction = 0;
  for (std::size_t k = 0; k < loads.size(); ++k) {
    worst = std::max(worst, results[k].worst_residual);
    fraction += results[k].solid_fraction / double(loads.size());
    report::PlotLine curve{loads[k].seed == 0 ? line("%g kPa", loads[k].stress / 1e3) : "", {}, {}, false};
    for (const auto& s : results[k].curve) {
      o.csv += line("%g,%zu,%.5f,%.2f,%.2f,%.6f\n", loads[k].stress, std::size_t(r.soil.seed) + loads[k].seed, s.strain,
                    s.axial_stress, s.lateral_stress, s.volume_strain);
      curve.x.push_back(s.strain);
      curve.y.push_back(s.axial_stress / s.lateral_stress - 1);
    }
    o.plot.lines.push_back(curve);
  }
  const auto strength = triaxial_strength(results, r.soil.grain.cohesion_pressure > 0);
  o.json["friction_angle"] = angle_json(strength.steady_angle);
  o.json["cohesion_Pa"] = strength.steady_cohesion;
  o.json["cohesion_error_Pa"] = strength.steady_cohesion_error;
  o.json["peak_friction_angle"] = angle_json(strength.peak_angle);
  o.json["peak_cohesion_Pa"] = strength.peak_cohesion;
  o.json["peak_cohesion_error_Pa"] = strength.peak_cohesion_error;
  o.json["solid_fraction"] = fraction;
  o.text = line(
      "steady: friction angle %.1f +- %.1f deg, cohesion %.0f Pa\npeak:   friction angle %.1f +- %.1f deg, "
      "cohesion %.0f Pa\nsolid fraction before shear %.3f\n",
      strength.steady_angle.degrees, strength.steady_angle.error, strength.steady_cohesion, strength.peak_angle.degrees,
      strength.peak_angle.error, strength.peak_cohesion, fraction);
  o.plot.notes = {line("Friction angle: steady %.1f +- %.1f, peak %.1f +- %.1f degrees.", strength.steady_angle.degrees,
                       strength.steady_angle.error, strength.peak_angle.degrees, strength.peak_angle.error)};
  finish(o, worst);
  return o;
}

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

SoilTestOutcome plate(const SoilTestRequest& r) {
  if (r.plate_widths.size() < 2)
    throw InputError("soil test plate: two plate widths or more are needed for k_c and k_phi");
  std::vector<terrain::PlateSettings> settings(r.plate_widths.size());
  Index steps = 0;
  for (std::size_t k = 0; k < settings.size(); ++k) {
    settings[k].width_grains = r.plate_widths[k];
    if (r.quick) {
      settings[k].bed_depth = 2;
      settings[k].growth_time = 3;
    }
    settings[k].steps_per_time = steps_per_gravity_time(settings[k].steps_per_time, r);
    steps = std::max(steps, terrain::plate_steps(settings[k]));
  }
  const std::size_t count = settings.size() * std::size_t(r.seeds);
  std::vector<terrain::PlateResult> results(count);
  SoilTestOutcome o = begin("plate", r);
  Runs runs("plate", r, count, steps);
  runs([&](std::size_t k, const TestPace& pace) {
    results[k] = plate_test(seeded(r, k / settings.size()), settings[k % settings.size()], pace,
                            k + 1 == count ? &o.scene : nullptr);
  });
  o.csv = "plate_width_m,seed,sinkage_m,pressure_Pa\n";
  o.plot.x_label = "sinkage [mm]";
  o.plot.y_label = "pressure [kPa]";
  const terrain::BekkerFit fit = fit_bekker(results);
  double worst = 0;
  for (std::size_t k = 0; k < count; ++k) {
    worst = std::max(worst, results[k].worst_residual);
    report::PlotLine curve{k < settings.size() ? line("b = %.0f mm", 1e3 * results[k].width) : "", {}, {}, true};
    report::PlotLine fitted{k < settings.size() ? line("Bekker, %.0f mm", 1e3 * results[k].width) : "", {}, {}, false};
    curve.colour = fitted.colour = int(k % settings.size());
    for (const auto& s : results[k].curve) {
      o.csv += line("%.4f,%zu,%.6f,%.2f\n", results[k].width, std::size_t(r.soil.seed) + k / settings.size(), s.sinkage,
                    s.pressure);
      if (s.sinkage < 0) continue;
      curve.x.push_back(1e3 * s.sinkage);
      curve.y.push_back(s.pressure / 1e3);
      fitted.x.push_back(1e3 * s.sinkage);
      fitted.y.push_back((fit.k_c / results[k].width + fit.k_phi) * std::pow(s.sinkage, fit.n) / 1e3);
    }
    o.plot.lines.push_back(curve);
    if (k < settings.size()) o.plot.lines.push_back(fitted);
  }
  report_bekker(o, fit);
  finish(o, worst);
  return o;
}

/// Mean of the beds over depth, and from the least to the most of them as a band.
void draw_cone(report::LinePlot& plot, const std::vector<terrain::ConeResult>& results) {
  plot.x_label = "depth of the cone's base [mm]";
  plot.y_label = "force over base area [kPa]";
  report::PlotLine band, mean;
  const std::vector<terrain::ConeSample> profile = mean_profile(results);
  for (std::size_t k = 0; k < profile.size(); ++k) {
    const auto [least, most] = std::minmax_element(results.begin(), results.end(), [k](const auto& a, const auto& b) {
      return a.profile[k].pressure < b.profile[k].pressure;
    });
    band.x.push_back(1e3 * profile[k].depth);
    mean.x.push_back(1e3 * profile[k].depth);
    band.y.push_back(least->profile[k].pressure / 1e3);
    band.most.push_back(most->profile[k].pressure / 1e3);
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
  const terrain::MeanError ci = terrain::mean_error(index);
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

SoilTestOutcome cone(const SoilTestRequest& r) {
  terrain::ConeSettings settings;
  settings.diameter_grains = r.cone_diameter;
  if (r.quick) settings.speed = 0.2;
  settings.steps_per_time = steps_per_gravity_time(settings.steps_per_time, r);
  std::vector<terrain::ConeResult> results(std::size_t(r.seeds));
  SoilTestOutcome o = begin("cone", r);
  Runs runs("cone", r, results.size(), terrain::cone_steps(settings));
  runs([&](std::size_t k, const TestPace& pace) {
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

}  // namespace

SoilTestOutcome run_soil_test(const std::string& test, const SoilTestRequest& r) {
  terrain::check(r.soil);
  if (r.seeds < 1) throw InputError("soil test: at least one seed is needed");
  if (test == "repose") return repose(r);
  if (test == "shear") return shear(r);
  if (test == "triaxial") return triaxial(r);
  if (test == "plate") return plate(r);
  if (test == "cone") return cone(r);
  throw InputError("soil test: \"" + test + "\" is none of repose, shear, plate, cone, triaxial");
}

}  // namespace gonogo::lab
