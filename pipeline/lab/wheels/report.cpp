#include "pipeline/lab/wheels/report.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/files/file.h"
#include "base/format.h"
#include "base/json/config.h"
#include "pipeline/report/figure/chart.h"

namespace gonogo::lab {
namespace {

const Predicted& at(const Predictor& p, std::size_t point, Quantity q) {
  static const Predicted none;
  const auto found = p.point[point].find(q);
  return found == p.point[point].end() ? none : found->second;
}

/// "pull [N]"
std::string label_of(Quantity q) {
  const std::string unit = unit_of(q);
  return name_of(q) + (unit.empty() ? "" : " [" + unit + "]");
}

std::string led_text(const BenchmarkPoint& p, const std::vector<Quantity>& led) {
  std::string text;
  for (const Quantity q : led) text += line("%8.4g", p.led.at(q));
  return text;
}

std::string table_of(const WheelReport& r, Quantity q) {
  std::string text = "  ";
  for (const Quantity l : r.benchmark.led) text += line("%8.8s", name_of(l));
  text += line("  %-16s", ("measured " + label_of(q)).c_str());
  for (const Predictor& p : r.predictor) text += "  " + p.name;
  text += "\n";
  for (std::size_t i = 0; i < r.benchmark.point.size(); ++i) {
    const BenchmarkPoint& point = r.benchmark.point[i];
    const auto measured = point.measured.find(q);
    if (measured == point.measured.end()) continue;
    text += "  " + led_text(point, r.benchmark.led);
    text += line("  %9.4g +- %.2g", measured->second.mean, r.benchmark.scatter_at(point, q));
    for (const Predictor& p : r.predictor) {
      const Predicted& x = at(p, i, q);
      text += line("  %9.4g [%.4g, %.4g]", x.mean, x.low, x.high);
    }
    text += "\n";
  }
  return text;
}

std::string agreement_line(const std::string& name, const Agreement& a, bool forces) {
  std::string text = line("    %-42s rms %.3g, bias %+.3g", name.c_str(), a.rms, a.bias);
  if (forces) text += line(", over load %.3f, %+.3f", a.rms_over_load, a.bias_over_load);
  text += line(", median error %.0f %%", 100 * a.median_relative_error);
  if (a.with_scatter > 0)
    text += line(", %d of %d inside the scatter, %d by the band", a.inside, a.with_scatter, a.band_meets);
  return text + "\n";
}

bool is_force(Quantity q) { return q == Quantity::pull || q == Quantity::side_force; }

Json predicted_json(const Predicted& p) {
  return Json::Object{{"mean", p.mean}, {"standard_error", p.error}, {"low", p.low}, {"high", p.high}};
}

Json points_json(const WheelReport& r) {
  Json points = Json::array();
  for (std::size_t i = 0; i < r.benchmark.point.size(); ++i) {
    const BenchmarkPoint& p = r.benchmark.point[i];
    Json one;
    for (const auto& [quantity, value] : p.led) one[column_of(quantity)] = value;
    one["load_N"] = load_at(r.benchmark, p);
    for (const auto& [quantity, m] : p.measured) {
      Json of =
          Json::Object{{"measured", m.mean}, {"tests", m.tests}, {"scatter", r.benchmark.scatter_at(p, quantity)}};
      for (const Predictor& predictor : r.predictor)
        if (const Predicted& x = at(predictor, i, quantity); std::isfinite(x.mean))
          of[predictor.name] = predicted_json(x);
      one[column_of(quantity)] = std::move(of);
    }
    points.push_back(std::move(one));
  }
  return points;
}

}  // namespace

std::vector<ComparedValue> compared(const Benchmark& b, const Predictor& p, Quantity q, double up_to) {
  std::vector<ComparedValue> values;
  for (std::size_t i = 0; i < b.point.size(); ++i) {
    const BenchmarkPoint& point = b.point[i];
    const auto measured = point.measured.find(q);
    if (measured == point.measured.end() || point.led.at(b.led.front()) > up_to) continue;
    const Predicted& x = at(p, i, q);
    values.push_back({.measured = measured->second.mean,
                      .predicted = x.mean,
                      .scatter = b.scatter_at(point, q),
                      .load = load_at(b, point),
                      .low = x.low,
                      .high = x.high});
  }
  return values;
}

Predictor interpolated(const Benchmark& b, const PublishedPrediction& published) {
  const Quantity led = b.led.front();
  const std::vector<BenchmarkPoint>& known = published.point;
  Predictor p{published.name, published.source, {}};
  for (const BenchmarkPoint& point : b.point) {
    const double x = point.led.at(led);
    auto above = std::find_if(known.begin(), known.end(), [&](const auto& k) { return k.led.at(led) >= x; });
    if (above == known.end()) --above;
    const auto below = above == known.begin() ? above : above - 1;
    const double from = below->led.at(led), to = above->led.at(led);
    const double share = to > from ? std::clamp((x - from) / (to - from), 0.0, 1.0) : 0;
    auto& here = p.point.emplace_back();
    for (const auto& [quantity, m] : below->measured) {
      const double value = m.mean + share * (above->measured.at(quantity).mean - m.mean);
      here[quantity] = {value, 0, value, value};
    }
  }
  return p;
}

WheelReport report_of(const Benchmark& b, const WheelOutcome& outcome, const std::vector<Predictor>& formulas,
                      const std::vector<std::string>& missing) {
  const bool simulated = !outcome.predictor.point.empty();
  WheelReport r{b, outcome, {}, missing, {}};
  if (simulated) r.predictor.push_back(outcome.predictor);
  r.predictor.insert(r.predictor.end(), formulas.begin(), formulas.end());
  for (const PublishedPrediction& p : b.published) r.predictor.push_back(interpolated(b, p));
  if (!simulated) return r;
  for (const Bound& bound : b.bound) {
    const Agreement a = agreement_of(compared(b, outcome.predictor, bound.quantity, bound.up_to));
    r.check.push_back({bound, measure_of(a, bound.measure)});
  }
  return r;
}

int failures(const WheelReport& r) {
  return int(std::count_if(r.check.begin(), r.check.end(), [](const CheckedBound& c) { return !c.holds(); }));
}

Json as_json(const WheelReport& r) {
  Json j;
  j["title"] = r.benchmark.title;
  j["source"] = r.benchmark.source;
  j["soil"] = r.benchmark.soil_file + ", " + r.benchmark.soil.name;
  j["grain_m"] = r.outcome.bed.grain;
  j["bed_m"].push_back(r.outcome.bed.length);
  j["bed_m"].push_back(r.outcome.bed.width);
  j["bed_m"].push_back(r.outcome.bed.depth);
  j["drive_s"] = r.outcome.bed.time;
  j["grains_per_width"] = r.outcome.grains_per_width;
  j["coarse"] = r.outcome.coarse();
  j["trials"] = r.outcome.trials;
  j["failed_trials"] = r.outcome.failed;
  j["band_over"] = Json::array();
  for (const std::string& what : r.outcome.varied) j["band_over"].push_back(what);
  j["points"] = points_json(r);
  for (const Predictor& p : r.predictor)
    for (const Quantity q : r.benchmark.measured())
      j["agreement"][p.name][name_of(q)] = as_json(agreement_of(compared(r.benchmark, p, q)));
  j["missing"] = Json::array();
  for (const std::string& why : r.missing) j["missing"].push_back(why);
  j["bounds"] = Json::array();
  for (const CheckedBound& c : r.check) {
    Json one = Json::Object{{"quantity", name_of(c.bound.quantity)}, {"measure", c.bound.measure}};
    if (std::isfinite(c.bound.up_to)) one["up_to"] = c.bound.up_to;
    one["at_most"] = c.bound.at_most;
    one["measured"] = c.measured;
    one["holds"] = c.holds();
    one["why"] = c.bound.why;
    j["bounds"].push_back(std::move(one));
  }
  return j;
}

std::string as_text(const WheelReport& r) {
  const WheelOutcome& o = r.outcome;
  std::string text = r.benchmark.title + "\n";
  if (o.trials > 0)
    text +=
        line("  grains of %.3g mm, %.1f per wheel width%s; bed %.2f x %.2f x %.2f m; %.1f s; %d trials, %d failed\n",
             1e3 * o.bed.grain, o.grains_per_width,
             o.coarse() ? line(", COARSE: lugs are %.1f of half a grain", o.lug_grains).c_str() : "", o.bed.length,
             o.bed.width, o.bed.depth, o.bed.time, o.trials, o.failed);
  for (const std::string& why : r.missing) text += "  " + why + "\n";
  for (const Quantity q : r.benchmark.measured()) {
    text += table_of(r, q);
    for (const Predictor& p : r.predictor)
      text += agreement_line(p.name, agreement_of(compared(r.benchmark, p, q)), is_force(q));
  }
  for (const CheckedBound& c : r.check) {
    const std::string to = std::isfinite(c.bound.up_to) ? " up to " + number_text(c.bound.up_to) : "";
    text += line("  %s of %s%s: %.3g, at most %.3g (%s)%s\n", c.bound.measure.c_str(), name_of(c.bound.quantity),
                 to.c_str(), c.measured, c.bound.at_most, c.bound.why.c_str(), c.holds() ? "" : "  DOES NOT HOLD");
  }
  return text;
}

namespace {

Predicted read_predicted(const Config& c) {
  return {c.number("mean"), c.number("standard_error"), c.number("low"), c.number("high")};
}

/// Fails where the file's point is not that of the benchmark.
std::map<Quantity, Predicted> read_point(const Config& c, const BenchmarkPoint& point, const std::string& predictor) {
  for (const auto& [quantity, value] : point.led)
    if (quantity != Quantity::load && std::fabs(c.number(column_of(quantity)) - value) > 1e-6)
      c.fail(column_of(quantity), "is not " + number_text(value) + " as in the benchmark; run its trials again");
  std::map<Quantity, Predicted> predicted;
  for (const auto& [quantity, measured] : point.measured)
    if (const auto of = c.object_if(column_of(quantity)))
      if (const auto own = of->object_if(predictor)) predicted[quantity] = read_predicted(*own);
  return predicted;
}

WheelOutcome read_outcome(const Config& c, const Benchmark& b) {
  WheelOutcome o;
  o.bed.grain = c.number("grain_m", {1e-4, 1});
  const std::vector<double> bed = c.numbers("bed_m", {0, 100});
  if (bed.size() != 3) c.fail("bed_m", "needs three numbers: length, width and depth");
  o.bed.length = bed[0];
  o.bed.width = bed[1];
  o.bed.depth = bed[2];
  o.bed.time = c.number("drive_s", {0, 1e6});
  o.grains_per_width = c.number("grains_per_width", {0, 1e6});
  o.lug_grains = lug_grains(wheel_of(b), o.bed.grain);
  o.trials = int(c.integer("trials", {1, 1e9}));
  o.failed = int(c.integer("failed_trials", {0, double(o.trials)}));
  o.varied = c.texts("band_over");
  const std::vector<Config> points = c.objects("points");
  if (points.size() != b.point.size())
    c.fail("points", "has " + std::to_string(points.size()) + " points, the benchmark " +
                         std::to_string(b.point.size()) + "; run its trials again");
  o.predictor.name = kOurs;
  for (std::size_t i = 0; i < points.size(); ++i)
    o.predictor.point.push_back(read_point(points[i], b.point[i], o.predictor.name));
  return o;
}

}  // namespace

std::vector<WheelOutcome> read_outcomes(const std::filesystem::path& file, const std::vector<Benchmark>& benchmarks) {
  const Config c = Config::read(file);
  std::vector<WheelOutcome> outcomes;
  for (const Benchmark& b : benchmarks) {
    if (!c.has(b.name)) c.fail(b.name, "is not in the file; name only benchmarks that are");
    outcomes.push_back(read_outcome(c.object(b.name), b));
  }
  return outcomes;
}

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
  report::LinePlot plot{.title = b.title, .x_label = column_of(x), .y_label = column_of(q)};
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
        lines[k].add(point.led.at(x), k == 0 ? measured->second.mean : mean_at(r.predictor[k - 1], i, q));
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
    points.add(share(v.measured, v.load), share(v.predicted, v.load));
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
