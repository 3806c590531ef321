#include <algorithm>
#include <cmath>
#include <set>

#include "base/file.h"
#include "base/line.h"
#include "pipeline/lab/wheels/report.h"
#include "pipeline/report/figure/line_plot.h"

namespace gonogo::lab {
namespace {

double mean_at(const Predictor& p, std::size_t point, Quantity q) {
  const auto found = p.point[point].find(q);
  return found == p.point[point].end() ? campaign::kNaN : found->second.mean;
}

std::string csv_of(const WheelReport& r) {
  std::string csv;
  for (const Quantity q : r.benchmark.led) csv += std::string(column_of(q)) + ",";
  csv += "quantity,measured,scatter,tests,predictor,predicted,standard_error,low,high\n";
  for (std::size_t i = 0; i < r.benchmark.point.size(); ++i) {
    const BenchmarkPoint& point = r.benchmark.point[i];
    for (const auto& [q, m] : point.measured)
      for (const Predictor& p : r.predictor) {
        const auto found = p.point[i].find(q);
        if (found == p.point[i].end()) continue;
        const Predicted& x = found->second;
        for (const Quantity l : r.benchmark.led) csv += line("%g,", point.led.at(l));
        csv += line("%s,%.6g,%.6g,%d,\"%s\",%.6g,%.6g,%.6g,%.6g\n", column_of(q), m.mean,
                    r.benchmark.scatter_at(point, q), m.tests, p.name.c_str(), x.mean, x.error, x.low, x.high);
      }
  }
  return csv;
}

/// Over the last led quantity; where two are led, a curve for each value of the first.
report::LinePlot plot_of(const WheelReport& r, Quantity q) {
  const Benchmark& b = r.benchmark;
  const Quantity x = b.led.back();
  report::LinePlot plot;
  plot.title = b.title;
  plot.x_label = column_of(x);
  plot.y_label = column_of(q);
  std::set<double> groups;
  for (const BenchmarkPoint& p : b.point) groups.insert(b.led.size() > 1 ? p.led.at(b.led.front()) : 0);
  int colour = 0;
  for (const double group : groups) {
    const std::string of = b.led.size() > 1 ? line(", %s %g", name_of(b.led.front()), group) : "";
    std::vector<report::PlotLine> lines{{"measured" + of, {}, {}, true}};
    for (const Predictor& p : r.predictor) lines.push_back({p.name + of, {}, {}, false});
    for (std::size_t i = 0; i < b.point.size(); ++i) {
      const BenchmarkPoint& point = b.point[i];
      const auto measured = point.measured.find(q);
      if (measured == point.measured.end()) continue;
      if (b.led.size() > 1 && point.led.at(b.led.front()) != group) continue;
      for (std::size_t k = 0; k < lines.size(); ++k) {
        lines[k].x.push_back(point.led.at(x));
        lines[k].y.push_back(k == 0 ? measured->second.mean : mean_at(r.predictor[k - 1], i, q));
      }
    }
    for (report::PlotLine& l : lines) {
      if (groups.size() > 1) l.colour = colour;
      plot.lines.push_back(std::move(l));
    }
    ++colour;
  }
  return plot;
}

/// What all wheels have in common: pull over load, and on given slopes slip.
report::PlotLine overview_points(const Benchmark& b, const Predictor& p) {
  const std::vector<Quantity> has = b.measured();
  const auto measures = [&](Quantity q) { return std::find(has.begin(), has.end(), q) != has.end(); };
  const Quantity q = b.leads(Quantity::slope)             ? Quantity::slip
                     : measures(Quantity::traction_slope) ? Quantity::traction_slope
                                                          : Quantity::pull;
  const auto share = [q](double x, double load) {
    return q == Quantity::slip ? x : q == Quantity::traction_slope ? std::tan(to_radians(x)) : x / load;
  };
  report::PlotLine points{b.name + (q == Quantity::slip ? " (slip), " : ", ") + p.name, {}, {}, true};
  for (const ComparedValue& v : compared(b, p, q)) {
    points.x.push_back(share(v.measured, v.load));
    points.y.push_back(share(v.predicted, v.load));
  }
  return points;
}

bool is_published(const Benchmark& b, const Predictor& p) {
  return std::any_of(b.published.begin(), b.published.end(), [&](const auto& other) { return other.name == p.name; });
}

/// Predicted over measured by trials and formulas, of all wheels.
report::LinePlot overview(const std::vector<WheelReport>& reports) {
  report::LinePlot plot;
  plot.title = "Pull over load, slip on slopes: measured and predicted";
  plot.x_label = "measured";
  plot.y_label = "predicted";
  plot.from_zero = false;
  std::vector<report::PlotLine> wheels;
  double low = 0, high = 0;
  for (const WheelReport& r : reports)
    for (const Predictor& p : r.predictor) {
      if (is_published(r.benchmark, p)) continue;
      report::PlotLine points = overview_points(r.benchmark, p);
      if (points.x.empty()) continue;
      low = std::min(low, *std::min_element(points.x.begin(), points.x.end()));
      high = std::max(high, *std::max_element(points.x.begin(), points.x.end()));
      wheels.push_back(std::move(points));
    }
  plot.lines.push_back({"equal", {low, high}, {low, high}, false});
  plot.lines.insert(plot.lines.end(), wheels.begin(), wheels.end());
  return plot;
}

std::string over_time_csv(const WheelReport& r) {
  std::string csv = std::string(column_of(r.benchmark.led.front())) + ",second,slip\n";
  for (std::size_t i = 0; i < r.outcome.slip_over_time.size(); ++i)
    for (std::size_t k = 0; k < r.outcome.slip_over_time[i].size(); ++k)
      csv += line("%g,%zu,%.4f\n", r.benchmark.point[i].led.at(r.benchmark.led.front()), k + 1,
                  r.outcome.slip_over_time[i][k]);
  return csv;
}

}  // namespace

void write_report(const std::filesystem::path& folder, const WheelReport& r) {
  create_folder(folder);
  const std::string& name = r.benchmark.name;
  write_file_atomically(folder / (name + ".csv"), csv_of(r));
  if (!r.outcome.slip_over_time.empty()) write_file_atomically(folder / (name + "_over_time.csv"), over_time_csv(r));
  for (const Quantity q : r.benchmark.measured())
    report::draw_line_plot(folder / (name + "_" + name_of(q) + ".png"), plot_of(r, q));
}

void write_overview(const std::filesystem::path& folder, const std::vector<WheelReport>& reports) {
  create_folder(folder);
  Json all;
  for (const WheelReport& r : reports) all[r.benchmark.name] = as_json(r);
  const report::LinePlot wheels = overview(reports);
  if (wheels.lines.size() > 1) report::draw_line_plot(folder / "wheels.png", wheels);
  write_file_atomically(folder / "wheels.json", all.dump(2) + "\n");
}

}  // namespace gonogo::lab
