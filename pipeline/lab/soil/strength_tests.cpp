#include <algorithm>

#include "base/line.h"
#include "pipeline/lab/soil/test_runs.h"
#include "terrain/soil_test/shear.h"
#include "terrain/soil_test/triaxial.h"

namespace gonogo::lab {
namespace {

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

void report_triaxial(SoilTestOutcome& o, const terrain::TriaxialStrength& strength, double fraction) {
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
}

}  // namespace

std::vector<terrain::ShearResult> run_shear(const SoilTestRequest& r, terrain::TestScene* scene) {
  const std::vector<Load> loads = loads_of(r);
  terrain::ShearSettings settings;
  if (r.quick) settings.travel = 2;
  std::vector<terrain::ShearResult> results(loads.size());
  Runs runs("shear", r, loads.size(), terrain::shear_steps(settings));
  runs([&](std::size_t k, const terrain::TestPace& pace) {
    terrain::ShearSettings own = settings;
    own.normal_stress = loads[k].stress;
    own.steps_per_time = steps_per_stress_time(own.normal_stress, own.steps_per_time, r);
    const terrain::TestSoil soil = seeded(r, loads[k].seed);
    results[k] = shear_test(terrain::test_bed(soil, 10, 6, 8, pace.threads), soil.laws(), own, pace,
                            k + 1 == loads.size() ? scene : nullptr);
  });
  return results;
}

SoilTestOutcome shear(const SoilTestRequest& r) {
  const std::vector<Load> loads = loads_of(r);
  SoilTestOutcome o = begin("shear", r);
  const std::vector<terrain::ShearResult> results = run_shear(r, &o.scene);
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
  runs([&](std::size_t k, const terrain::TestPace& pace) {
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
  report_triaxial(o, triaxial_strength(results, r.soil.grain.cohesion_pressure > 0), fraction);
  finish(o, worst);
  return o;
}

}  // namespace gonogo::lab
