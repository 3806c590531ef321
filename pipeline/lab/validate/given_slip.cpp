#include "pipeline/lab/validate/given_slip.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/line.h"
#include "terrain/soil_test/line_fit.h"

namespace gonogo::lab {
namespace {

/// Slip and traction slope [deg] of each test; slips were set to multiples of 0.05.
constexpr struct {
  double slip, slope;
} kTests[] = {{0.0, -1.66}, {0.05, 8.10}, {0.1, 13.82}, {0.1, 16.93}, {0.2, 20.12}, {0.3, 19.86},
              {0.3, 22.30}, {0.4, 21.53}, {0.4, 24.90}, {0.4, 23.13}, {0.5, 24.38}, {0.6, 25.72},
              {0.6, 21.76}, {0.6, 25.63}, {0.7, 25.03}, {0.7, 29.75}, {0.8, 31.34}, {0.8, 33.61}};
/// Largest distance between two tests at the same slip (at 0.7) [deg].
constexpr double kScatter = 4.72;

GivenSlip run_slip(const SimulantRun& run, const campaign::TrialSetup& setup, const terrain::MacroscopicSoil& soil,
                   GivenSlip s) {
  std::vector<double> slopes, depths;
  for (const campaign::TrialRecord& r :
       run_simulant(run, setup, replicates(simulant_variables(run, setup, soil, 0), run.seeds))) {
    if (r.verdict == campaign::Verdict::unknown || r.pull.empty()) continue;
    slopes.push_back(terrain::angle_of_tangent(r.pull.front().pull, 0).degrees);
    depths.push_back(r.pull.front().sinkage);
  }
  const terrain::MeanError slope = terrain::mean_error(slopes);
  s.trials = int(slopes.size());
  s.traction_slope = slopes.empty() ? std::nan("") : slope.mean;
  s.traction_slope_error = slope.error;
  s.sinkage = terrain::mean_error(depths).mean;
  return s;
}

}  // namespace

std::vector<GivenSlip> measured_traction() {
  std::map<double, std::vector<double>> at;
  for (const auto& t : kTests) at[t.slip].push_back(t.slope);
  std::vector<GivenSlip> points;
  for (const auto& [slip, slopes] : at) {
    const auto [low, high] = std::minmax_element(slopes.begin(), slopes.end());
    const double mean = terrain::mean_error(slopes).mean;
    points.push_back({.slip = slip, .measured = mean, .lowest = *low, .highest = *high, .traction_slope = mean});
  }
  return points;
}

std::vector<GivenSlip> run_given_slips(const SimulantRun& run) {
  const terrain::MacroscopicSoil soil = simulant_soil("grc3", run.state);
  campaign::TrialSetup setup = simulant_setup(run, soil);
  std::vector<GivenSlip> points;
  for (const GivenSlip& s : measured_traction()) {
    setup.task = campaign::parse_task(line("single_wheel:slip=%.6f", rim_of(setup).slip_of_rim(s.slip)));
    points.push_back(run_slip(run, setup, soil, s));
  }
  return points;
}

double rms_traction_error(const std::vector<GivenSlip>& points) {
  double square = 0;
  for (const GivenSlip& p : points) square += std::pow(p.traction_slope - p.measured, 2);
  return std::sqrt(square / double(points.size()));
}

SoilFigure given_slip_figure(const SimulantRun& run, const std::vector<GivenSlip>& points) {
  SoilFigure f;
  f.name = "soils_trec";
  f.plot.title = "A wheel of MGRU3 on GRC-3, led at given slips";
  f.plot.x_label = "slip";
  f.plot.y_label = "slope that the pull would climb [deg]";
  f.plot.lines = {{"single-wheel tests", {}, {}, true}, {"gonogo", {}, {}, false}};
  for (const auto& t : kTests) {
    f.plot.lines[0].x.push_back(t.slip);
    f.plot.lines[0].y.push_back(t.slope);
  }
  f.csv = "slip,measured_deg,lowest_deg,highest_deg,traction_slope_deg,standard_error_deg,sinkage_m,trials\n";
  for (const GivenSlip& p : points) {
    f.csv += line("%g,%.2f,%g,%g,%.3f,%.3f,%.5f,%d\n", p.slip, p.measured, p.lowest, p.highest, p.traction_slope,
                  p.traction_slope_error, p.sinkage, p.trials);
    f.plot.lines[1].x.push_back(p.slip);
    f.plot.lines[1].y.push_back(p.traction_slope);
  }
  const double rms = rms_traction_error(points);
  f.check = {{"rmse_traction_slope_trec_deg",
              "rms difference of the traction slope from the tests' means, at most as far as two tests at one slip are "
              "apart [deg]",
              0, kScatter, rms}};
  f.plot.notes = {
      line("rms difference %.1f degrees; soil by %s, never tuned on pulls", rms, run.calibration.filename().c_str())};
  return f;
}

}  // namespace gonogo::lab
