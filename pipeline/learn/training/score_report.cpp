#include "pipeline/learn/training/score_report.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <utility>

#include "base/line.h"
#include "learning/score/calibration.h"
#include "pipeline/learn/training/train_model.h"

namespace gonogo::learn {
namespace {

using Terms = std::vector<double> (*)(std::span<const double>, std::span<const int>);

/// The model's terms minus those of the baseline whose own mean is least.
Json minus_best(const Forecasts& forecasts, Terms terms, std::uint64_t seed) {
  const auto total = [](const std::vector<double>& x) { return std::accumulate(x.begin(), x.end(), 0.0); };
  std::string best;
  std::vector<double> least;
  for (const char* name : kBaselines) {
    if (!forecasts.baselines.count(name)) continue;
    std::vector<double> now = terms(forecasts.baselines.at(name), forecasts.happened);
    if (!least.empty() && !(total(now) < total(least))) continue;
    best = name;
    least = std::move(now);
  }
  Json json = difference_json(terms(forecasts.model, forecasts.happened), least, seed);
  json["baseline"] = best;
  return json;
}

}  // namespace

Json difference_json(std::span<const double> terms, std::span<const double> others, std::uint64_t seed) {
  std::vector<double> difference;
  for (std::size_t k = 0; k < terms.size(); ++k) difference.push_back(terms[k] - others[k]);
  const learning::Interval interval = learning::bootstrap_mean(difference, seed);
  Json json;
  json["value"] = interval.value;
  json["low"] = interval.low;
  json["high"] = interval.high;
  return json;
}

Json score_forecasts(const Forecasts& forecasts, std::uint64_t seed) {
  const std::size_t bins = std::clamp<std::size_t>(forecasts.happened.size() / 20, 2, 10);
  Json json;
  json["model"] = learning::score_report(forecasts.model, forecasts.happened, bins, seed);
  for (const char* name : kBaselines)
    if (const auto found = forecasts.baselines.find(name); found != forecasts.baselines.end())
      json[name] = learning::score_report(found->second, forecasts.happened, bins, seed);
  if (forecasts.baselines.empty()) return json;
  Json rest = Json::object();
  rest["brier"] = minus_best(forecasts, learning::brier_terms, seed);
  rest["log_loss_nat"] = minus_best(forecasts, learning::log_loss_terms, seed);
  json["model_minus_best"] = std::move(rest);
  return json;
}

std::vector<std::string> forecaster_names(const Json& scores) {
  std::vector<std::string> names = {"model"};
  for (const char* who : kBaselines)
    if (scores.find(who)) names.push_back(who);
  return names;
}

std::string best_forecaster(const Json& scores, const std::string& score) {
  std::string best;
  for (const std::string& who : forecaster_names(scores))
    if (best.empty() || scores.at(who).at(score).number() < scores.at(best).at(score).number()) best = who;
  return best;
}

std::string scores_text(const Json& scores) {
  std::string text = line("%-20s %-24s %-24s %8s %11s %s\n", "P(go) of", "Brier [95 %]", "log loss [95 %]", "accuracy",
                          "calibration", "slope of calibration");
  for (const std::string& who : forecaster_names(scores)) {
    const Json& s = scores.at(who);
    text += line("%-20s %6.4f [%6.4f, %6.4f]  %6.4f [%6.4f, %6.4f]  %8.3f %11.4f", who.c_str(), s.at("brier").number(),
                 s.at("brier_low").number(), s.at("brier_high").number(), s.at("log_loss_nat").number(),
                 s.at("log_loss_low").number(), s.at("log_loss_high").number(), s.at("accuracy").number(),
                 s.at("calibration_error").number());
    text += s.at("calibration_slope").is_number()
                ? line(" %.2f +- %.2f\n", s.at("calibration_slope").number(), s.at("calibration_slope_error").number())
                : "\n";
  }
  text += "best by Brier score: " + best_forecaster(scores, "brier") +
          "; best by log loss: " + best_forecaster(scores, "log_loss_nat") + "\n";
  const Json &model = scores.at("model"), &rest = scores.at("model_minus_best");
  for (const auto& [score, name] : {std::pair("brier", "Brier score"), std::pair("log_loss_nat", "log loss")})
    text += line("%s, model minus %s: %+.4f [%+.4f, %+.4f]\n", name, rest.at(score).at("baseline").string().c_str(),
                 rest.at(score).at("value").number(), rest.at(score).at("low").number(),
                 rest.at(score).at("high").number());
  text += line("Brier of the model = reliability %.4f - resolution %.4f + uncertainty %.4f + within bins %.4f\n",
               model.at("brier_reliability").number(), model.at("brier_resolution").number(),
               model.at("brier_uncertainty").number(), model.at("brier_within_bins").number());
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
  if (const Json* others = report.find("other_trials"))
    for (const Json& other : others->items())
      text += line("%lld trials of another fidelity help: %s\n", static_cast<long long>(other.at("trials").integer()),
                   other.at("fidelity").string().c_str());
  text += "outcomes:";
  for (const auto& [name, count] : counts.at("outcomes").members())
    if (count.integer() > 0) text += line(" %s %lld", name.c_str(), static_cast<long long>(count.integer()));
  text += line("\nsampler %s, %lld epochs; scores by %lld-fold cross-validation:\n",
               report.at("sampler").string().c_str(), static_cast<long long>(report.at("epochs").integer()),
               static_cast<long long>(report.at("cross_validation").at("folds").integer()));
  if (report.at("stand_in").boolean())
    text += "the sampler " + report.at("sampler_wanted").string() + " could not be used, " +
            report.at("sampler").string() + " stood in: " + report.at("stand_in_reason").string() + "\n";
  if (const Json* found = report.find("annealer")) {
    const Json& annealer = *found;
    text += line(
        "emulated annealer: %lld working qubits of %s, %lld of %lld pairs of units masked; thermometer %s, last "
        "scale %.3f\n",
        static_cast<long long>(annealer.at("working_qubits").integer()), annealer.at("graph").string().c_str(),
        static_cast<long long>(annealer.at("masked_pairs").integer()),
        static_cast<long long>(annealer.at("pairs").integer()), annealer.at("thermometer").string().c_str(),
        annealer.at("last_scale").number());
  }
  if (const double power = report.at("calibration_power").number(); power != 1)
    text += line("probabilities are calibrated: raised to %.3f\n", power);
  return text + scores_text(report.at("cross_validation"));
}

}  // namespace gonogo::learn
