#include "pipeline/lab/soil/soil_tests.h"

#include <algorithm>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/lab/soil/test_runs.h"
#include "terrain/soil_test/repose.h"

namespace gonogo::lab {
namespace {

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
  runs([&](std::size_t k, const terrain::TestPace& pace) {
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
  const MeanError mean = mean_error(angles);
  const double error = angles.size() > 1 ? mean.error : results[0].angle.error;
  o.json["angle_of_repose"] = angle_json({mean.mean, error});
  o.json["rest_speed_m_per_s"] = rest;
  o.text = line("angle of repose: %.1f +- %.1f deg\n", mean.mean, error);
  o.plot.notes = {line("Angle of repose %.1f +- %.1f degrees.", mean.mean, error)};
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
