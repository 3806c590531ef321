#include <algorithm>
#include <cstdio>
#include <string>

#include "base/file.h"
#include "base/line.h"
#include "pipeline/learn/evaluation/evaluate_model.h"
#include "pipeline/learn/training/score_report.h"
#include "pipeline/report/figure/chart.h"
#include "pipeline/report/figure/pictures.h"

namespace gonogo::learn {
namespace {

std::string reliability_csv(const Json& scores) {
  std::string text = "forecaster,trials,mean_forecast,frequency,frequency_low,frequency_high\n";
  for (const std::string& who : forecaster_names(scores))
    for (const Json& bin : scores.at(who).at("reliability").items())
      text += line("%s,%lld,%.17g,%.17g,%.17g,%.17g\n", who.c_str(), static_cast<long long>(bin.at("count").integer()),
                   bin.at("mean_forecast").number(), bin.at("frequency").number(), bin.at("frequency_low").number(),
                   bin.at("frequency_high").number());
  return text;
}

std::string missing_csv(const Json& curve) {
  std::string text = "hidden,subsets,trials,forecaster,brier,log_loss_nat,model_minus_brier,low,high\n";
  for (const Json& point : curve.items())
    for (const auto& [who, brier] : point.at("brier").members()) {
      text += line("%lld,%lld,%lld,%s,%.17g,%.17g", static_cast<long long>(point.at("hidden").integer()),
                   static_cast<long long>(point.at("subsets").integer()),
                   static_cast<long long>(point.at("trials").integer()), who.c_str(), brier.number(),
                   point.at("log_loss_nat").at(who).number());
      const Json* difference = point.at("difference").find(who);  // not of the model from itself
      text += difference ? line(",%.17g,%.17g,%.17g\n", difference->at("brier").at("value").number(),
                                difference->at("brier").at("low").number(), difference->at("brier").at("high").number())
                         : ",,,\n";
    }
  return text;
}

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

report::Chart reliability_chart(const Json& scores) {
  report::Chart chart{.title = "Reliability: forecast and what happened",
                      .x_label = "forecast P(go)",
                      .y_label = "share that passed, 95 % interval",
                      .diagonal = true,
                      .series = {}};
  for (const std::string& who : forecaster_names(scores)) {
    report::ChartSeries series{.label = in_words(who), .x = {}, .y = {}, .low = {}, .high = {}};
    for (const Json& bin : scores.at(who).at("reliability").items()) {
      series.x.push_back(bin.at("mean_forecast").number());
      series.y.push_back(bin.at("frequency").number());
      if (who != "model") continue;
      series.low.push_back(bin.at("frequency_low").number());
      series.high.push_back(bin.at("frequency_high").number());
    }
    if (who != "base_rate") chart.series.push_back(std::move(series));
  }
  return chart;
}

report::Chart missing_chart(const Json& curve) {
  report::Chart chart{.title = "Brier score with inputs hidden (lower is better)",
                      .x_label = "inputs hidden",
                      .y_label = "Brier score",
                      .x_high = double(curve.items().size() - 1),
                      .y_high = 0,
                      .series = {}};
  for (const auto& [who, first] : curve.items().front().at("brier").members()) {
    report::ChartSeries series{.label = in_words(who), .x = {}, .y = {}, .low = {}, .high = {}};
    for (const Json& point : curve.items()) {
      series.x.push_back(double(point.at("hidden").integer()));
      series.y.push_back(point.at("brier").at(who).number());
      chart.y_high = std::max(chart.y_high, 1.35 * series.y.back());
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

std::string missing_text(const Json& curve) {
  std::string text = line(
      "Brier score with inputs hidden on %lld trials (the model sums them out, the others take their mean); model "
      "minus the others [95 %%]\n",
      static_cast<long long>(curve.items().front().at("trials").integer()));
  std::string head = line("%-7s %7s", "hidden", "subsets");
  for (const auto& [who, brier] : curve.items().front().at("brier").members()) head += line(" %20s", who.c_str());
  text += head + "  minus logistic_regression   minus neural_network\n";
  for (const Json& point : curve.items()) {
    text += line("%-7lld %7lld", static_cast<long long>(point.at("hidden").integer()),
                 static_cast<long long>(point.at("subsets").integer()));
    for (const auto& [who, brier] : point.at("brier").members()) text += line(" %20.4f", brier.number());
    for (const char* who : {"logistic_regression", "neural_network"}) {
      const Json& d = point.at("difference").at(who).at("brier");
      text += line("  %+.4f [%+.4f, %+.4f]", d.at("value").number(), d.at("low").number(), d.at("high").number());
    }
    text += "\n";
  }
  return text;
}

std::vector<std::filesystem::path> write_evaluation(const std::filesystem::path& folder, const Json& report,
                                                    const Json& scores) {
  std::filesystem::create_directories(folder);
  std::vector<std::filesystem::path> files = {folder / "evaluation.json", folder / "reliability.csv"};
  write_file_atomically(files[0], report.dump(2) + "\n");
  write_file_atomically(files[1], reliability_csv(scores));
  const Json* curve = report.find("missing");
  if (curve) {
    files.push_back(folder / "missing.csv");
    write_file_atomically(files.back(), missing_csv(*curve));
  }
  if (!report::pictures_available()) return files;
  std::vector<report::Chart> charts = {reliability_chart(scores)};
  if (curve) charts.push_back(missing_chart(*curve));
  files.push_back(folder / "evaluation.png");
  report::write_charts(files.back(),
                       line("P(go) on %lld trials that training did not see",
                            static_cast<long long>(scores.at("model").at("trials").integer())),
                       charts);
  return files;
}

}  // namespace gonogo::learn
