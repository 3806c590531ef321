#include "pipeline/lab/validate/slope_slip.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/line.h"
#include "terrain/soil_test/line_fit.h"

namespace gonogo::lab {
namespace {

struct Published {
  double slope, measured, simulated;  // [deg], [-], [-]; the simulation's between its slopes of 0, 5, 10, 15, 20, 25
};
constexpr Published kPublished[] = {{0.27, 0.0315, 0.0422},  {5.24, 0.0515, 0.1100},  {10.03, 0.1347, 0.2112},
                                    {14.96, 0.4341, 0.4134}, {20.23, 0.7560, 0.6246}, {25.10, 0.8846, 0.7220}};
/// Of the tests of 2022.
constexpr struct {
  double slope, measured;  // [deg], [-]
} kRepeated[] = {{0.274, 0.0251},  {5.574, 0.0508},  {10.030, 0.1043}, {15.307, 0.3551},
                 {19.980, 0.7384}, {25.188, 0.8383}, {30.149, 0.8967}};

std::vector<campaign::DesignPoint> points_of(const SimulantRun& run, const campaign::TrialSetup& setup,
                                             const terrain::MacroscopicSoil& soil) {
  std::vector<campaign::DesignPoint> points;
  for (const Published& p : kPublished)
    for (campaign::DesignPoint& point : replicates(simulant_variables(run, setup, soil, p.slope), run.seeds)) {
      point.index = points.size();
      points.push_back(std::move(point));
    }
  return points;
}

/// Places of a trial's wheel at the end of each second of its driving [m], from its observer.
struct Way {
  double from = 0;  // park time [s]
  std::vector<double> x;

  campaign::TrialWatch watch() {
    campaign::TrialWatch w;
    w.start = [this] { x.clear(); };
    w.sample = [this](const campaign::TrialSample& s) {
      if (s.time >= from + double(x.size()) - 1e-9) x.push_back(s.x);
    };
    return w;
  }
};

/// Slip of each second that all trials of a slope have driven. `rim_speed` [m/s]
std::vector<double> slip_over_time(const std::vector<campaign::TrialRecord>& records, const std::vector<Way>& ways,
                                   double slope, double rim_speed) {
  std::vector<double> sum;
  std::size_t seconds = std::size_t(1e9), trials = 0;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (records[k].verdict == campaign::Verdict::unknown || ways[k].x.empty()) continue;
    if (records[k].point.variables[campaign::contract().variable_index("slope_along")] != slope) continue;
    seconds = std::min(seconds, ways[k].x.size() - 1);
    ++trials;
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
  for (const Published& p : kPublished)
    slips.push_back({.slope = p.slope, .measured = p.measured, .published = p.simulated, .slip = p.simulated});
  return slips;
}

std::vector<SlopeSlip> repeated_slope_slips() {
  std::vector<SlopeSlip> slips = published_slope_slips();
  for (SlopeSlip& s : slips) {
    const auto* above = std::find_if(std::begin(kRepeated), std::end(kRepeated) - 1,
                                     [&](const auto& r) { return r.slope > std::max(s.slope, kRepeated[0].slope); });
    const auto* below = above - 1;
    const double share = std::max(0.0, (s.slope - below->slope) / (above->slope - below->slope));
    s.slip = below->measured + share * (above->measured - below->measured);
  }
  return slips;
}

std::vector<SlopeSlip> run_slope_slip(const SimulantRun& run) {
  const terrain::MacroscopicSoil soil = simulant_soil("grc1", run.state);
  const campaign::TrialSetup setup = simulant_setup(run, soil);
  const std::vector<campaign::DesignPoint> points = points_of(run, setup, soil);
  std::vector<Way> ways(points.size(), Way{setup.park_time, {}});
  std::vector<campaign::TrialWatch> watch;
  for (Way& w : ways) watch.push_back(w.watch());
  const std::vector<campaign::TrialRecord> records = run_simulant(run, setup, points, watch);
  const Rim rim = rim_of(setup);
  const std::size_t slip = campaign::contract().measure_index("slip"),
                    sinkage = campaign::contract().measure_index("sinkage");
  std::vector<SlopeSlip> result;
  for (const Published& p : kPublished) {
    SlopeSlip s{.slope = p.slope, .measured = p.measured, .published = p.simulated};
    std::vector<double> slips, depths;
    for (const campaign::TrialRecord& r : records) {
      if (r.verdict == campaign::Verdict::unknown) continue;
      if (r.point.variables[campaign::contract().variable_index("slope_along")] != p.slope) continue;
      slips.push_back(rim.slip_over_grousers(r.measures[slip]));
      depths.push_back(r.measures[sinkage]);
    }
    s.over_time = slip_over_time(records, ways, p.slope, kSimulantWheelSpeed * (rim.radius + rim.grouser));
    const terrain::MeanError mean = terrain::mean_error(slips), depth = terrain::mean_error(depths);
    s.trials = int(slips.size());
    s.slip = slips.empty() ? std::nan("") : mean.mean;
    s.slip_error = mean.error;
    s.sinkage = depth.mean;
    result.push_back(s);
  }
  return result;
}

double rms_slip_error(const std::vector<SlopeSlip>& points, double steepest) {
  double square = 0;
  int count = 0;
  for (const SlopeSlip& p : points)
    if (p.slope <= steepest) {
      square += (p.slip - p.measured) * (p.slip - p.measured);
      ++count;
    }
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

SoilFigure slope_slip_figure(const SimulantRun& run, const std::vector<SlopeSlip>& points) {
  const bool rover = run.vehicle == kSimulantRover;
  const std::string key = rover ? "mgru3_rover" : "mgru3";
  SoilFigure f;
  f.name = "soils_" + key;
  f.plot.title = rover ? "MGRU3 on GRC-1: slip over slope" : "A wheel of MGRU3 on GRC-1: slip over slope";
  f.plot.x_label = "slope [deg]";
  f.plot.y_label = "slip";
  f.plot.lines = {{"rover, measured in 2021", {}, {}, true},
                  {"one wheel, published discrete elements", {}, {}, true},
                  {rover ? "rover, gonogo" : "one wheel, gonogo", {}, {}, false},
                  {"rover, measured in 2022", {}, {}, true}};
  for (const auto& r : kRepeated) {
    f.plot.lines[3].x.push_back(r.slope);
    f.plot.lines[3].y.push_back(r.measured);
  }
  f.csv = "slope_deg,slip_experiment,slip_published_dem,slip,slip_standard_error,sinkage_m,trials\n";
  for (const SlopeSlip& p : points) {
    f.csv += line("%g,%g,%g,%.4f,%.4f,%.5f,%d\n", p.slope, p.measured, p.published, p.slip, p.slip_error, p.sinkage,
                  p.trials);
    const double y[] = {p.measured, p.published, p.slip};
    for (std::size_t k = 0; k < 3; ++k) {
      f.plot.lines[k].x.push_back(p.slope);
      f.plot.lines[k].y.push_back(y[k]);
    }
  }
  f.over_time = over_time_csv(points);
  const double all = rms_slip_error(points), gentle = rms_slip_error(points, 15);
  f.check = {
      {"rmse_slip_" + key, "rms slip error over the six slopes (published simulation: 0.094)", 0, 0.094, all},
      {"rmse_slip_" + key + "_to_15deg", "the same up to 15 degrees (published simulation: 0.050)", 0, 0.05, gentle}};
  f.plot.notes = {line("rms slip error %.3f, up to 15 degrees %.3f; soil by %s, never tuned on slips", all, gentle,
                       run.calibration.filename().c_str())};
  return f;
}

}  // namespace gonogo::lab
