#include "pipeline/learn/score_report.h"

#include <algorithm>
#include <cstdio>

#include "learning/score/score.h"
#include "pipeline/learn/train_model.h"

namespace gonogo::pipeline {
namespace {

template <class... Values>
std::string line(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace

Json score_forecasts(const Forecasts& forecasts, std::uint64_t seed) {
  const std::size_t bins = std::clamp<std::size_t>(forecasts.happened.size() / 20, 2, 10);
  Json json;
  json["model"] = learning::score_report(forecasts.model, forecasts.happened, bins, seed);
  json["logistic_regression"] = learning::score_report(forecasts.logistic, forecasts.happened, bins, seed);
  json["base_rate"] = learning::score_report(forecasts.base_rate, forecasts.happened, bins, seed);
  return json;
}

std::string scores_text(const Json& scores) {
  std::string text = line("%-20s %8s %9s %9s %12s\n", "P(go) of", "Brier", "log loss", "accuracy", "calibration");
  for (const char* who : {"model", "logistic_regression", "base_rate"}) {
    const Json& s = scores.at(who);
    text += line("%-20s %8.4f %9.4f %9.3f %12.4f\n", who, s.at("brier").number(), s.at("log_loss_nat").number(),
                 s.at("accuracy").number(), s.at("calibration_error").number());
  }
  const Json& model = scores.at("model");
  text += line(
      "a perfectly calibrated forecaster with the model's forecasts: Brier %.4f (95 %% below %.4f), calibration "
      "error %.4f (95 %% below %.4f)\n",
      model.at("floor_brier_mean").number(), model.at("floor_brier_95").number(),
      model.at("floor_calibration_error_mean").number(), model.at("floor_calibration_error_95").number());
  text += "reliability of the model: forecast -> frequency [95 % interval], trials\n";
  for (const Json& bin : model.at("reliability").items())
    text += line("  %.3f -> %.3f [%.3f, %.3f], %lld\n", bin.at("mean_forecast").number(), bin.at("frequency").number(),
                 bin.at("frequency_low").number(), bin.at("frequency_high").number(),
                 static_cast<long long>(bin.at("count").integer()));
  return text;
}

std::string report_text(const Json& report) {
  const Json &counts = report.at("counts"), &failures = report.at("failures");
  std::string text = line(
      "%lld trials: trained on %lld, left out %lld that failed (rate %.3f, 95 %% interval %.3f to %.3f)\n",
      static_cast<long long>(counts.at("trials").integer()), static_cast<long long>(counts.at("trained_on").integer()),
      static_cast<long long>(counts.at("left_out_unknown").integer()), failures.at("rate").number(),
      failures.at("rate_low").number(), failures.at("rate_high").number());
  text += "outcomes:";
  for (const auto& [name, count] : counts.at("outcomes").members())
    if (count.integer() > 0) text += line(" %s %lld", name.c_str(), static_cast<long long>(count.integer()));
  text += line("\nsampler %s, %lld epochs; scores by %lld-fold cross-validation:\n",
               report.at("sampler").string().c_str(), static_cast<long long>(report.at("epochs").integer()),
               static_cast<long long>(report.at("cross_validation").at("folds").integer()));
  return text + scores_text(report.at("cross_validation"));
}

}  // namespace gonogo::pipeline
