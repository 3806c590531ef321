#include "pipeline/learn/evaluation/evaluation_checks.h"

#include <cmath>

#include "base/line.h"

namespace gonogo::learn {
namespace {

Json check(const std::string& what, bool holds, double value, double limit) {
  Json json;
  json["what"] = what;
  json["holds"] = holds;
  json["value"] = value;
  json["limit"] = limit;
  json["low"] = Json();
  json["high"] = Json();
  return json;
}

Json with_interval(Json json, const Json& interval) {
  json["low"] = interval.at("low");
  json["high"] = interval.at("high");
  return json;
}

}  // namespace

Json evaluation_checks(const Json& report) {
  Json checks = Json::array();
  const Json &model = report.at("scores").at("model"), &rest = report.at("scores").at("model_minus_best");
  for (const auto& [score, name] : {std::pair("brier", "Brier score"), std::pair("log_loss_nat", "log loss")}) {
    const Json& best = rest.at(score);
    checks.push_back(with_interval(check(std::string(name) + " minus that of " + best.at("baseline").string(),
                                         best.at("low").number() <= 0, best.at("value").number(), 0),
                                   best));
  }
  const double above = model.at("calibration_error").number() - model.at("floor_calibration_error_mean").number();
  checks.push_back(
      check("calibration error above its floor", above <= kMaxCalibrationError, above, kMaxCalibrationError));
  for (const Json& point : report.at("missing").items()) {
    if (point.at("hidden").integer() != kHiddenInputs) continue;
    for (const auto& [baseline, scores] : point.at("difference").members()) {
      if (baseline == "base_rate") continue;
      const Json& brier = scores.at("brier");
      checks.push_back(
          with_interval(check("two inputs hidden: Brier score minus that of " + baseline + " with mean imputation",
                              brier.at("value").number() < 0, brier.at("value").number(), 0),
                        brier));
    }
  }
  if (const Json* found = report.find("reconstruction"); found && !found->find("left_out")) {
    const Json &coverage = found->at("coverage"), &gain = found->at("gain_nat");
    const double miss = std::abs(coverage.at("value").number() - 0.9);
    checks.push_back(check("two inputs reconstructed: coverage of intervals of 90 % away from 0.9",
                           miss <= kMaxCoverageMiss, miss, kMaxCoverageMiss));
    Json loss;
    loss["low"] = -gain.at("high").number();
    loss["high"] = -gain.at("low").number();
    checks.push_back(with_interval(check("two inputs reconstructed: log loss minus that of their prior",
                                         gain.at("value").number() > 0, -gain.at("value").number(), 0),
                                   loss));
  }
  return checks;
}

std::string checks_text(const Json& checks) {
  std::string text = "checks of the model:\n";
  for (const Json& c : checks.items()) {
    text += line("  %-6s %-84s %+.4f", c.at("holds").boolean() ? "holds" : "misses", c.at("what").string().c_str(),
                 c.at("value").number());
    if (c.at("low").is_number()) text += line(" [%+.4f, %+.4f]", c.at("low").number(), c.at("high").number());
    text += line(", at most %.2f\n", c.at("limit").number());
  }
  return text;
}

}  // namespace gonogo::learn
