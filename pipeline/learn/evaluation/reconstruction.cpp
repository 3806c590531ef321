#include "pipeline/learn/evaluation/reconstruction.h"

#include <algorithm>
#include <cmath>

#include "base/cancel.h"
#include "base/line.h"
#include "learning/score/calibration.h"

namespace gonogo::learn {
namespace {

/// What the hidden values of one row and one variable scored, summed over the pairs.
struct Sums {
  double covered = 0, gain = 0, count = 0;
};

using Row = std::vector<Sums>;  // [variable]

constexpr double kLeast = 1e-12;  // of the probability of a bin

/// Adds what reconstruct() said about one hidden value.
void add(const learning::Encoder& encoder, const learning::UnknownVariable& said, const std::vector<double>& prior,
         double value, Sums& sums) {
  const auto bin = std::size_t(encoder.bin_of(value));
  sums.covered += value >= said.low && value <= said.high;
  sums.gain += std::log(std::max(kLeast, said.probability[bin])) - std::log(std::max(kLeast, prior[bin]));
  sums.count += 1;
}

Row scored_row(const Predictor& predictor, const learning::InputPrior& prior, std::span<const double> row,
               std::size_t outcome, const std::vector<std::size_t>& varying) {
  Row sums(row.size());
  std::vector<double> asked(row.begin(), row.end());
  for (std::size_t a : varying)
    for (std::size_t b : varying) {
      if (b >= a) break;
      asked[a] = asked[b] = NAN;
      const learning::JointAnswer answer = predictor.reconstruct(asked, outcome);
      for (std::size_t v : {a, b}) {
        add(predictor.model().layout.encoders()[v], answer.variables[v], prior[v], row[v], sums[v]);
        asked[v] = row[v];
      }
    }
  return sums;
}

std::vector<std::size_t> whole_rows(const learning::TrainingTable& table, const ReconstructionSettings& settings) {
  std::vector<std::size_t> rows;
  for (std::size_t n : learning::permutation(table.row_count(), settings.seed, 0x72656373)) {
    const auto row = table.row(n);
    if (rows.size() < settings.max_rows && std::none_of(row.begin(), row.end(), [](double x) { return std::isnan(x); }))
      rows.push_back(n);
  }
  return rows;
}

Json interval_json(const std::vector<double>& terms, std::uint64_t seed) {
  const learning::Interval interval = learning::bootstrap_mean(terms, seed);
  Json json;
  json["value"] = interval.value;
  json["low"] = interval.low;
  json["high"] = interval.high;
  return json;
}

Json left_out(const char* reason) {
  Json json;
  json["left_out"] = reason;
  return json;
}

Json report(const std::vector<Row>& scored, const Predictor& predictor, const std::vector<std::size_t>& varying,
            std::uint64_t seed) {
  std::vector<double> covered, gain;
  Json variables = Json::object();
  for (const Row& row : scored) {
    Sums all;
    for (const Sums& sums : row) all = {all.covered + sums.covered, all.gain + sums.gain, all.count + sums.count};
    covered.push_back(all.covered / all.count);
    gain.push_back(all.gain / all.count);
  }
  for (std::size_t v : varying) {
    Sums all;
    for (const Row& row : scored)
      all = {all.covered + row[v].covered, all.gain + row[v].gain, all.count + row[v].count};
    Json entry;
    entry["coverage"] = all.covered / all.count;
    entry["gain_nat"] = all.gain / all.count;
    variables[predictor.model().layout.encoders()[v].name()] = std::move(entry);
  }
  Json json;
  json["rows"] = Json(std::uint64_t(scored.size()));
  json["pairs"] = Json(std::uint64_t(varying.size() * (varying.size() - 1) / 2));
  json["coverage"] = interval_json(covered, seed);
  json["gain_nat"] = interval_json(gain, seed);
  json["variables"] = std::move(variables);
  return json;
}

}  // namespace

Json reconstruction_scores(const Predictor& predictor, const learning::TrainingTable& table,
                           const ReconstructionSettings& settings) {
  const learning::Model& model = predictor.model();
  std::vector<std::size_t> varying;
  for (std::size_t v = 0; v < model.layout.variable_count(); ++v)
    if (model.layout.encoders()[v].unit_count() > 0) varying.push_back(v);
  const std::vector<std::size_t> rows = whole_rows(table, settings);
  if (varying.size() < 2) return left_out("fewer than two inputs vary");
  if (rows.empty()) return left_out("every trial has an unknown input");
  const learning::InputPrior prior =
      model.input_prior.empty() ? learning::uniform_prior(model.layout) : model.input_prior;
  std::vector<Row> scored(rows.size());
#pragma omp parallel for schedule(dynamic)
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (!cancel_requested())
      scored[k] = scored_row(predictor, prior, table.row(rows[k]), table.outcome[rows[k]], varying);
  stop_if_cancelled();
  return report(scored, predictor, varying, settings.seed);
}

std::string reconstruction_text(const Json& scores) {
  if (const Json* reason = scores.find("left_out")) return "no score of reconstruction: " + reason->string() + "\n";
  const Json &coverage = scores.at("coverage"), &gain = scores.at("gain_nat");
  std::string text = line(
      "two inputs reconstructed from the outcome and the others (%lld trials, %lld pairs): intervals of 90 %% hold "
      "%.3f [%.3f, %.3f]; log score above the prior's %+.3f [%+.3f, %+.3f] nat\n",
      static_cast<long long>(scores.at("rows").integer()), static_cast<long long>(scores.at("pairs").integer()),
      coverage.at("value").number(), coverage.at("low").number(), coverage.at("high").number(),
      gain.at("value").number(), gain.at("low").number(), gain.at("high").number());
  for (const auto& [name, entry] : scores.at("variables").members())
    text += line("  %-24s %.3f  %+.3f\n", name.c_str(), entry.at("coverage").number(), entry.at("gain_nat").number());
  return text;
}

}  // namespace gonogo::learn
