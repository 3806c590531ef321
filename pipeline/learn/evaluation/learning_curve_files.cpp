#include <algorithm>
#include <map>

#include "base/file.h"
#include "base/line.h"
#include "base/mean_error.h"
#include "pipeline/learn/evaluation/learning_curve.h"
#include "pipeline/learn/training/score_report.h"
#include "pipeline/report/figure/chart.h"
#include "pipeline/report/figure/pictures.h"

namespace gonogo::learn {
namespace {

/// Scores of each forecaster at one number of trials, one of each subset.
using ByName = std::map<std::string, std::vector<double>>;

std::map<std::size_t, ByName> collected(const Json& curve, const std::string& score) {
  std::map<std::size_t, ByName> result;
  for (const Json& entry : curve.at("points").items())
    for (const auto& [name, value] : entry.at(score).members())
      result[std::size_t(entry.at("trials").integer())][name].push_back(value.number());
  return result;
}

std::vector<std::string> names() {
  std::vector<std::string> result = {"model"};
  result.insert(result.end(), std::begin(kBaselines), std::end(kBaselines));
  return result;
}

std::string best_of(const ByName& scores) {
  return std::min_element(
             scores.begin(), scores.end(),
             [](const auto& a, const auto& b) { return mean_error(a.second).mean < mean_error(b.second).mean; })
      ->first;
}

std::string table_of(const Json& curve, const std::string& score, const std::string& title) {
  std::string text = title + "\n" + line("%7s %7s", "trials", "subsets");
  for (const std::string& name : names()) text += line(" %20s", name.c_str());
  text += "  best\n";
  for (const auto& [trials, scores] : collected(curve, score)) {
    text += line("%7zu %7zu", trials, scores.begin()->second.size());
    for (const std::string& name : names()) text += line(" %20.4f", mean_error(scores.at(name)).mean);
    text += "  " + best_of(scores) + "\n";
  }
  return text;
}

report::Chart chart_of(const Json& curve) {
  report::Chart chart{.title = "Brier score on held-out trials (lower is better)",
                      .x_label = "trials trained on",
                      .y_label = "mean over subsets, standard error",
                      .x_low = INFINITY,
                      .x_high = 0,
                      .y_high = 0,
                      .log_x = true,
                      .legend_right = true,
                      .series = {}};
  const auto points = collected(curve, "brier");
  for (const std::string& name : names()) {
    if (name == "base_rate") continue;
    report::ChartSeries series{.label = name, .x = {}, .y = {}, .low = {}, .high = {}};
    std::replace(series.label.begin(), series.label.end(), '_', ' ');
    for (const auto& [trials, scores] : points) {
      const MeanError s = mean_error(scores.at(name));
      series.x.push_back(double(trials));
      series.y.push_back(s.mean);
      series.low.push_back(s.mean - s.error);
      series.high.push_back(s.mean + s.error);
      chart.x_low = std::min(chart.x_low, series.x.back() / 1.25);
      chart.x_high = std::max(chart.x_high, series.x.back() * 1.25);
      chart.y_high = std::max(chart.y_high, 1.2 * series.high.back());
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

std::string learning_curve_text(const Json& curve) {
  if (curve.at("points").items().empty()) return "no model is ready: other processes train all of them\n";
  const std::string held_out = curve.at("held_out").dump() + " held-out trials, mean over the subsets";
  const auto elsewhere = curve.at("elsewhere").integer();
  return table_of(curve, "brier", "Brier score of P(go) on " + held_out) +
         table_of(curve, "log_loss_nat", "log loss [nat] on " + held_out) +
         (elsewhere > 0 ? "models that other processes are still training: " + std::to_string(elsewhere) + "\n" : "");
}

std::vector<std::filesystem::path> write_learning_curve(const std::filesystem::path& folder, const Json& curve) {
  std::string csv = "trials,subset,forecaster,brier,log_loss_nat\n";
  for (const Json& entry : curve.at("points").items())
    for (const std::string& name : names())
      csv += entry.at("trials").dump() + "," + entry.at("subset").dump() + "," + name +
             line(",%.17g,%.17g\n", entry.at("brier").at(name).number(), entry.at("log_loss_nat").at(name).number());
  std::vector<std::filesystem::path> files = {folder / "learning_curve.csv"};
  write_file_atomically(files[0], csv);
  if (!report::pictures_available() || curve.at("points").items().empty()) return files;
  files.push_back(folder / "learning_curve.png");
  report::write_charts(files.back(), "P(go) by the number of trials", {chart_of(curve)});
  return files;
}

}  // namespace gonogo::learn
