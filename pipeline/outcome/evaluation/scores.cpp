#include "pipeline/outcome/evaluation/scores.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/format.h"
#include "base/parallel/host_loop.h"

namespace gonogo::outcome {
namespace {

/// Share of ones, with half a trial of each kind added: never exactly 0 or 1.
double base_rate(std::span<const int> label, const std::vector<std::size_t>& fold, std::size_t without) {
  double ones = 0.5, count = 1;
  for (std::size_t n = 0; n < label.size(); ++n) {
    if (!fold.empty() && fold[n] == without) continue;
    ones += label[n];
    count += 1;
  }
  return ones / count;
}

}  // namespace

std::map<std::string, std::vector<double>> Baselines::forecasts(std::span<const double> points) const {
  std::map<std::string, std::vector<double>> result;
  const std::size_t width = logistic.mean.size(), count = points.size() / width;
  for (std::size_t n = 0; n < count; ++n) {
    const auto point = points.subspan(n * width, width);
    result["logistic_regression"].push_back(logistic(point));
    result["quadratic_logistic"].push_back(quadratic(point));
    result["neural_network"].push_back(network(point));
    result["base_rate"].push_back(base_rate);
  }
  result["gaussian_process"] = process.probabilities(points);
  return result;
}

Baselines fit_baselines(const learning::TrainingTable& table, std::span<const int> label) {
  return {.logistic = learning::fit_logistic(table, label),
          .quadratic = learning::fit_quadratic(table, label),
          .process = learning::fit_gaussian_process(table, label),
          .network = learning::fit_network(table, label),
          .base_rate = base_rate(label, {}, 0)};
}

std::map<std::string, std::vector<double>> cross_validate_baselines(const learning::TrainingTable& table,
                                                                    std::span<const int> label,
                                                                    const std::vector<std::size_t>& fold,
                                                                    std::size_t fold_count,
                                                                    const std::function<void()>& beside) {
  std::vector<double> logistic(label.size()), quadratic(label.size()), network(label.size());
  // Those that take longest first.
  const std::size_t others = beside ? 1 : 0;
  for_each_on_host(others + 3 * fold_count, 1, [&](std::size_t task) {
    if (task < others) return beside();
    const std::size_t k = task - others;
    const auto forecast = [&](std::vector<double>& result, const auto& fit) {
      learning::forecast_fold(table, label, fold, k % fold_count, fit, result);
    };
    if (k < fold_count)
      forecast(quadratic, [](const auto& rows, auto labels) { return learning::fit_quadratic(rows, labels); });
    else if (k < 2 * fold_count)
      forecast(network, [](const auto& rows, auto labels) { return learning::fit_network(rows, labels); });
    else
      forecast(logistic, [](const auto& rows, auto labels) { return learning::fit_logistic(rows, labels); });
  });
  std::map<std::string, std::vector<double>> result{
      {"logistic_regression", logistic}, {"quadratic_logistic", quadratic}, {"neural_network", network}};
  for (std::size_t n = 0; n < fold.size(); ++n) result["base_rate"].push_back(base_rate(label, fold, fold[n]));
  return result;
}

namespace {

using Terms = std::vector<double> (*)(std::span<const double>, std::span<const int>);

/// The model's terms minus those of the baseline whose own mean is least.
Scores::Difference minus_best(const Forecasts& forecasts, Terms terms, std::uint64_t seed) {
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
  return {best, mean_difference(terms(forecasts.model, forecasts.happened), least, seed)};
}

/// Calls visit(key, number) for every number of a forecaster's scores, in the order of the JSON object.
template <class ForecastScores, class Visit>
void visit_numbers(ForecastScores& scores, const Visit& visit) {
  visit("brier", scores.brier.value);
  visit("log_loss_nat", scores.log_loss.value);
  visit("accuracy", scores.accuracy);
  visit("calibration_error", scores.calibration_error);
  visit("brier_low", scores.brier.low);
  visit("brier_high", scores.brier.high);
  visit("log_loss_low", scores.log_loss.low);
  visit("log_loss_high", scores.log_loss.high);
  visit("brier_reliability", scores.parts.reliability);
  visit("brier_resolution", scores.parts.resolution);
  visit("brier_uncertainty", scores.parts.uncertainty);
  visit("brier_within_bins", scores.parts.within_bins);
  visit("calibration_slope", scores.line.slope);
  visit("calibration_slope_error", scores.line.slope_error);
  visit("calibration_offset", scores.line.offset);
  visit("calibration_offset_error", scores.line.offset_error);
  visit("floor_brier_mean", scores.floor.brier_mean);
  visit("floor_brier_95", scores.floor.brier_high);
  visit("floor_calibration_error_mean", scores.floor.calibration_mean);
  visit("floor_calibration_error_95", scores.floor.calibration_high);
}

Json forecaster_json(const learning::ForecastScores& scores) {
  Json json = Json::Object{{"trials", scores.trials}}, bins = Json::array();
  visit_numbers(scores, [&](const char* key, double x) { json[key] = x; });
  for (const learning::ReliabilityBin& bin : scores.reliability)
    bins.push_back(Json::Object{{"count", bin.count},
                                {"mean_forecast", bin.mean_forecast},
                                {"frequency", bin.frequency},
                                {"frequency_low", bin.low},
                                {"frequency_high", bin.high}});
  json["reliability"] = std::move(bins);
  return json;
}

learning::ForecastScores read_forecaster(const Json& json) {
  learning::ForecastScores scores;
  scores.trials = json.at("trials").unsigned_integer();
  visit_numbers(scores, [&](const char* key, double& x) {
    const Json& value = json.at(key);
    x = value.is_null() ? NAN : value.number();
  });
  for (const Json& bin : json.at("reliability").items())
    scores.reliability.push_back({bin.at("count").unsigned_integer(), bin.at("mean_forecast").number(),
                                  bin.at("frequency").number(), bin.at("frequency_low").number(),
                                  bin.at("frequency_high").number()});
  return scores;
}

Json difference_json(const Scores::Difference& difference) {
  Json json = interval_json(difference.value);
  json["baseline"] = difference.baseline;
  return json;
}

Scores::Difference read_difference(const Json& json) {
  return {json.at("baseline").string(), {json.at("value").number(), json.at("low").number(), json.at("high").number()}};
}

}  // namespace

learning::Interval mean_difference(std::span<const double> terms, std::span<const double> others, std::uint64_t seed) {
  std::vector<double> difference;
  for (std::size_t k = 0; k < terms.size(); ++k) difference.push_back(terms[k] - others[k]);
  return learning::bootstrap_mean(difference, seed);
}

Scores score_forecasts(const Forecasts& forecasts, std::uint64_t seed) {
  const std::size_t bins = std::clamp<std::size_t>(forecasts.happened.size() / 20, 2, 10);
  std::vector<const std::vector<double>*> forecast{&forecasts.model};
  Scores scores;
  scores.of.emplace_back("model", learning::ForecastScores());
  for (const char* name : kBaselines)
    if (const auto found = forecasts.baselines.find(name); found != forecasts.baselines.end()) {
      forecast.push_back(&found->second);
      scores.of.emplace_back(name, learning::ForecastScores());
    }
  for_each_on_host(forecast.size(), 1, [&](std::size_t k) {
    scores.of[k].second = learning::forecast_scores(*forecast[k], forecasts.happened, bins, seed);
  });
  if (forecasts.baselines.empty()) return scores;
  scores.brier = minus_best(forecasts, learning::brier_terms, seed);
  scores.log_loss = minus_best(forecasts, learning::log_loss_terms, seed);
  return scores;
}

std::string Scores::best_by(learning::Interval learning::ForecastScores::*score) const {
  const auto best = std::min_element(of.begin(), of.end(), [&](const auto& a, const auto& b) {
    return (a.second.*score).value < (b.second.*score).value;
  });
  return best->first;
}

Json interval_json(const learning::Interval& interval) {
  return Json::Object{{"value", interval.value}, {"low", interval.low}, {"high", interval.high}};
}

Json to_json(const Scores& scores) {
  Json json = Json::object();
  for (const auto& [name, of] : scores.of) json[name] = forecaster_json(of);
  if (!scores.brier.baseline.empty())
    json["model_minus_best"] =
        Json::Object{{"brier", difference_json(scores.brier)}, {"log_loss_nat", difference_json(scores.log_loss)}};
  return json;
}

Scores read_scores(const Json& json) {
  Scores scores;
  scores.of.emplace_back("model", read_forecaster(json.at("model")));
  for (const char* name : kBaselines)
    if (const Json* found = json.find(name)) scores.of.emplace_back(name, read_forecaster(*found));
  if (const Json* rest = json.find("model_minus_best")) {
    scores.brier = read_difference(rest->at("brier"));
    scores.log_loss = read_difference(rest->at("log_loss_nat"));
  }
  return scores;
}

std::string scores_text(const Scores& scores) {
  std::string text = line("%-20s %-24s %-24s %8s %11s %s\n", "P(go) of", "Brier [95 %]", "log loss [95 %]", "accuracy",
                          "calibration", "slope of calibration");
  for (const auto& [who, s] : scores.of) {
    text +=
        line("%-20s %6.4f [%6.4f, %6.4f]  %6.4f [%6.4f, %6.4f]  %8.3f %11.4f", who.c_str(), s.brier.value, s.brier.low,
             s.brier.high, s.log_loss.value, s.log_loss.low, s.log_loss.high, s.accuracy, s.calibration_error);
    text += std::isnan(s.line.slope) ? "\n" : line(" %.2f +- %.2f\n", s.line.slope, s.line.slope_error);
  }
  text += "best by Brier score: " + scores.best_by(&learning::ForecastScores::brier) +
          "; best by log loss: " + scores.best_by(&learning::ForecastScores::log_loss) + "\n";
  for (const auto& [rest, name] : {std::pair(&scores.brier, "Brier score"), std::pair(&scores.log_loss, "log loss")})
    text += line("%s, model minus %s: %+.4f [%+.4f, %+.4f]\n", name, rest->baseline.c_str(), rest->value.value,
                 rest->value.low, rest->value.high);
  const learning::ForecastScores& model = scores.model();
  text += line("Brier of the model = reliability %.4f - resolution %.4f + uncertainty %.4f + within bins %.4f\n",
               model.parts.reliability, model.parts.resolution, model.parts.uncertainty, model.parts.within_bins);
  text += line(
      "a perfectly calibrated forecaster with the model's forecasts: Brier %.4f (95 %% below %.4f), calibration "
      "error %.4f (95 %% below %.4f)\n",
      model.floor.brier_mean, model.floor.brier_high, model.floor.calibration_mean, model.floor.calibration_high);
  text += "reliability of the model: forecast -> frequency [95 % interval], trials\n";
  for (const learning::ReliabilityBin& bin : model.reliability)
    text += line("  %.3f -> %.3f [%.3f, %.3f], %zu\n", bin.mean_forecast, bin.frequency, bin.low, bin.high, bin.count);
  return text;
}

}  // namespace gonogo::outcome
