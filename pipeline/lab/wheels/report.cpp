#include "pipeline/lab/wheels/report.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/line.h"

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
  Json j;
  j["mean"] = p.mean;
  j["standard_error"] = p.error;
  j["low"] = p.low;
  j["high"] = p.high;
  return j;
}

Json points_json(const WheelReport& r) {
  Json points = Json::array();
  for (std::size_t i = 0; i < r.benchmark.point.size(); ++i) {
    const BenchmarkPoint& p = r.benchmark.point[i];
    Json one;
    for (const auto& [quantity, value] : p.led) one[column_of(quantity)] = value;
    one["load_N"] = load_at(r.benchmark, p);
    for (const auto& [quantity, m] : p.measured) {
      Json of;
      of["measured"] = m.mean;
      of["tests"] = m.tests;
      of["scatter"] = r.benchmark.scatter_at(p, quantity);
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
    Json one;
    one["quantity"] = name_of(c.bound.quantity);
    one["measure"] = c.bound.measure;
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

}  // namespace gonogo::lab
