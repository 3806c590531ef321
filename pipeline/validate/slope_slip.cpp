#include "pipeline/validate/slope_slip.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/line.h"
#include "base/progress.h"
#include "base/shipped.h"
#include "pipeline/trial/batch.h"
#include "pipeline/trial/trial.h"
#include "terrain/soil/soil_file.h"
#include "terrain/soil_test/line_fit.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::pipeline {
namespace {

struct Published {
  double slope, measured, simulated;  // [deg], [-], [-]; the simulation's between its slopes of 0, 5, 10, 15, 20, 25
};
constexpr Published kPublished[] = {{0.27, 0.0315, 0.0422},  {5.24, 0.0515, 0.1100},  {10.03, 0.1347, 0.2112},
                                    {14.96, 0.4341, 0.4134}, {20.23, 0.7560, 0.6246}, {25.10, 0.8846, 0.7220}};
constexpr double kWheelSpeed = 0.8;  // [rad/s]

TrialSetup setup_of(const SlopeSlipRun& run, const terrain::Calibration& table, const terrain::SoilFit& fit) {
  TrialSetup s;
  s.name = "MGRU3 wheel on GRC-1";
  s.rig = vehicle::read_wheel_rig(shipped_file("vehicles", "vehicle", "mgru3_wheel"));
  s.calibration_file = run.calibration;
  s.calibration = table;
  s.packing_folder = default_packing_folder();
  s.settled_on = run.gpu ? sim::Backend::cuda : sim::Backend::cpu;
  s.bed_length = run.length, s.bed_width = run.width, s.moving_patch = true;
  s.grain_density = fit.grain_density;
  s.packing_seeds = run.seeds;
  s.test_distance = 1e3, s.minimum_drive_time = run.time, s.time_limit = run.time;
  s.run_in_distance = 0;
  s.thresholds.immobile_speed = 0, s.thresholds.slid_back_share = 10;
  // So slow a wheel does little work: pushing settled grains apart by a hair is much beside it.
  s.thresholds.energy_error = 10;
  s.numerics = terrain::numerics_by_table(table, run.calibration, run.numerics);
  terrain::check_patch(s.patch(), s.calibration.grain_diameter);
  return s;
}

std::vector<DesignPoint> points_of(const SlopeSlipRun& run, const TrialSetup& setup,
                                   const terrain::MacroscopicSoil& soil) {
  std::vector<DesignPoint> points;
  for (const Published& p : kPublished)
    for (int k = 0; k < run.seeds; ++k) {
      DesignPoint point;
      point.index = points.size(), point.seed = std::uint64_t(k);
      point.variables.assign(contract().variables.size(), 0);
      const auto set = [&](const char* name, double value) {
        point.variables[contract().variable_index(name)] = value;
      };
      set("slope_along", p.slope), set("friction_angle", soil.friction_angle);
      set("relative_density", soil.relative_density), set("tyre_friction", run.wheel_friction);
      set("bed_depth", run.depth), set("commanded_speed", kWheelSpeed * setup.rig.radius);
      points.push_back(point);
    }
  return points;
}

/// Places of a trial's wheel at the end of each second of its driving [m], from its observer.
struct Way {
  double from = 0;  // park time [s]
  std::vector<double> x;

  TrialWatch watch() {
    TrialWatch w;
    w.start = [this] { x.clear(); };
    w.sample = [this](const TrialSample& s) {
      if (s.time >= from + double(x.size()) - 1e-9) x.push_back(s.x);
    };
    return w;
  }
};

std::vector<TrialRecord> run_all(const SlopeSlipRun& run, const TrialSetup& setup,
                                 const std::vector<DesignPoint>& points, std::vector<Way>& ways) {
  std::vector<TrialRecord> records(points.size());
  Progress progress("validate soils mgru3", "trials", points.size());
  std::size_t done = 0;
  if (run.gpu) {
    TrialBatch batch(setup, {sim::Backend::cuda, int(points.size()), 1});
    for (const DesignPoint& p : points) batch.start(p, ways[p.index].watch());
    while (batch.running() > 0)
      for (const TrialRecord& r : batch.advance()) records[r.point.index] = r, progress.update(++done, "");
    return records;
  }
  terrain::run_jobs(points.size(), run.threads, [&](std::size_t k) {
    records[k] = run_trial(setup, points[k], ways[k].watch());
#pragma omp critical(slope_slip_progress)
    progress.update(++done, "");
  });
  return records;
}

/// Slip of each second that all trials of a slope have driven. `rim_speed` [m/s]
std::vector<double> slip_over_time(const std::vector<TrialRecord>& records, const std::vector<Way>& ways, double slope,
                                   double rim_speed) {
  std::vector<double> sum;
  std::size_t seconds = std::size_t(1e9), trials = 0;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (records[k].verdict == Verdict::unknown || ways[k].x.empty()) continue;
    if (records[k].point.variables[contract().variable_index("slope_along")] != slope) continue;
    seconds = std::min(seconds, ways[k].x.size() - 1), ++trials;
    sum.resize(std::max(sum.size(), seconds));
    for (std::size_t i = 0; i < seconds; ++i) sum[i] += 1 - (ways[k].x[i + 1] - ways[k].x[i]) / rim_speed;
  }
  sum.resize(trials > 0 ? seconds : 0);
  for (double& slip : sum) slip /= double(trials);
  return sum;
}

}  // namespace

std::vector<SlopeSlip> published_slope_slips() {
  std::vector<SlopeSlip> slips;
  for (const Published& p : kPublished) slips.push_back({p.slope, p.measured, p.simulated, p.simulated, 0, 0, 0, {}});
  return slips;
}

std::vector<SlopeSlip> run_slope_slip(const SlopeSlipRun& run) {
  const auto file = terrain::read_soil(shipped_file("soils", "soil", "grc1"));
  const terrain::MacroscopicSoil soil = file.states.at(0).macroscopic();
  terrain::Calibration table = terrain::read_calibration(run.calibration);
  if (run.grain > 0) table.grain_diameter = run.grain;
  const TrialSetup setup = setup_of(run, table, fit_soil(table, soil));
  const std::vector<DesignPoint> points = points_of(run, setup, soil);
  prepare_trials(setup, points, run.threads);
  std::vector<Way> ways(points.size(), Way{setup.park_time, {}});
  const std::vector<TrialRecord> records = run_all(run, setup, points, ways);
  // A trial counts slip from the rim, the experiment from the circle over the grousers.
  const double rim_share = setup.rig.radius / (setup.rig.radius + setup.rig.lug_height);
  const std::size_t slip = contract().measure_index("slip"), sinkage = contract().measure_index("sinkage");
  std::vector<SlopeSlip> result;
  for (const Published& p : kPublished) {
    SlopeSlip s{p.slope, p.measured, p.simulated, 0, 0, 0, 0, {}};
    std::vector<double> slips, depths;
    for (const TrialRecord& r : records) {
      if (r.verdict == Verdict::unknown) continue;
      if (r.point.variables[contract().variable_index("slope_along")] != p.slope) continue;
      slips.push_back(1 - (1 - r.measures[slip]) * rim_share), depths.push_back(r.measures[sinkage]);
    }
    s.over_time = slip_over_time(records, ways, p.slope, kWheelSpeed * (setup.rig.radius + setup.rig.lug_height));
    const terrain::MeanError mean = terrain::mean_error(slips), depth = terrain::mean_error(depths);
    s.trials = int(slips.size());
    s.slip = slips.empty() ? std::nan("") : mean.mean, s.slip_error = mean.error, s.sinkage = depth.mean;
    result.push_back(s);
  }
  return result;
}

double rms_slip_error(const std::vector<SlopeSlip>& points, double steepest) {
  double square = 0;
  int count = 0;
  for (const SlopeSlip& p : points)
    if (p.slope <= steepest) square += (p.slip - p.measured) * (p.slip - p.measured), ++count;
  return std::sqrt(square / count);
}

namespace {

std::string over_time_csv(const std::vector<SlopeSlip>& points) {
  std::string csv = "slope_deg,second,slip\n";
  for (const SlopeSlip& p : points)
    for (std::size_t i = 0; i < p.over_time.size(); ++i) csv += line("%g,%zu,%.4f\n", p.slope, i + 1, p.over_time[i]);
  return csv;
}

}  // namespace

SoilFigure slope_slip_figure(const SlopeSlipRun& run, const std::vector<SlopeSlip>& points) {
  SoilFigure f;
  f.name = "soils_mgru3";
  f.plot.title = "MGRU3 wheel on GRC-1: slip over slope";
  f.plot.x_label = "slope [deg]", f.plot.y_label = "slip";
  f.plot.lines = {
      {"experiment", {}, {}, true}, {"published discrete elements", {}, {}, true}, {"gonogo", {}, {}, false}};
  f.csv = "slope_deg,slip_experiment,slip_published_dem,slip,slip_standard_error,sinkage_m,trials\n";
  for (const SlopeSlip& p : points) {
    f.csv += line("%g,%g,%g,%.4f,%.4f,%.5f,%d\n", p.slope, p.measured, p.published, p.slip, p.slip_error, p.sinkage,
                  p.trials);
    const double y[] = {p.measured, p.published, p.slip};
    for (std::size_t k = 0; k < 3; ++k) f.plot.lines[k].x.push_back(p.slope), f.plot.lines[k].y.push_back(y[k]);
  }
  f.over_time = over_time_csv(points);
  const double all = rms_slip_error(points), gentle = rms_slip_error(points, 15);
  f.check = {{"rmse_slip_mgru3", "rms slip error over the six slopes (published simulation: 0.094)", 0, 0.094, all},
             {"rmse_slip_mgru3_to_15deg", "the same up to 15 degrees (published simulation: 0.050)", 0, 0.05, gentle}};
  f.plot.notes = {line("rms slip error %.3f, up to 15 degrees %.3f; soil by %s, never tuned on slips", all, gentle,
                       run.calibration.filename().c_str())};
  return f;
}

}  // namespace gonogo::pipeline
