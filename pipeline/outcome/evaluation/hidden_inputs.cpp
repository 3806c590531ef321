#include "pipeline/outcome/evaluation/hidden_inputs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/format.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "learning/score/score.h"
#include "pipeline/outcome/evaluation/scores.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

using Subset = std::vector<std::size_t>;

/// All subsets of `size` of the variables in order, or `most` of them drawn by the seed.
std::vector<Subset> subsets_of(const std::vector<std::size_t>& variables, std::size_t size, std::size_t most,
                               std::uint64_t seed) {
  std::vector<Subset> all;
  const std::size_t count = variables.size();
  for (std::size_t mask = 0; mask < std::size_t(1) << count; ++mask) {
    if (std::size_t(std::popcount(mask)) != size) continue;
    Subset& subset = all.emplace_back();
    for (std::size_t k = 0; k < count; ++k)
      if (mask >> k & 1) subset.push_back(variables[k]);
  }
  if (all.size() <= most) return all;
  std::vector<Subset> chosen;
  const auto order = learning::permutation(all.size(), seed, 0x6869 + size);
  for (std::size_t k = 0; k < most; ++k) chosen.push_back(all[order[k]]);
  return chosen;
}

std::vector<double> forecasts(const Forecaster& forecaster, const learning::TrainingTable& table,
                              const std::vector<std::size_t>& rows, const Subset& hidden) {
  std::vector<double> p(rows.size());
  for_each_on_host(rows.size(), 1, [&](std::size_t k) {
    const auto row = table.row(rows[k]);
    std::vector<double> known(row.begin(), row.end());
    for (std::size_t v : hidden) known[v] = NAN;
    p[k] = std::clamp(forecaster.forecast(known), 1e-12, 1 - 1e-12);
  });
  return p;
}

/// Scores of every row, as means over the subsets.
struct MeanTerms {
  std::vector<double> brier, log_loss;
};

/// Calls `next` after each subset.
MeanTerms mean_terms(const Forecaster& forecaster, const learning::TrainingTable& table,
                     const std::vector<std::size_t>& rows, const std::vector<int>& label,
                     const std::vector<Subset>& subsets, const std::function<void()>& next) {
  MeanTerms mean{std::vector<double>(rows.size(), 0.0), std::vector<double>(rows.size(), 0.0)};
  const auto add = [&](std::vector<double>& sum, const std::vector<double>& terms) {
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += terms[k] / double(subsets.size());
  };
  for (const Subset& subset : subsets) {
    const std::vector<double> p = forecasts(forecaster, table, rows, subset);
    add(mean.brier, learning::brier_terms(p, label));
    add(mean.log_loss, learning::log_loss_terms(p, label));
    next();
  }
  return mean;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

}  // namespace

std::vector<MissingPoint> missing_curve(const std::vector<Forecaster>& forecasters,
                                        const learning::TrainingTable& table, std::span<const int> happened,
                                        const std::vector<std::size_t>& hideable, const MissingSettings& settings) {
  std::vector<std::size_t> rows = learning::permutation(table.row_count(), settings.seed, 0x726f);
  rows.resize(std::min(rows.size(), settings.max_rows));
  std::vector<int> label;
  for (std::size_t n : rows) label.push_back(happened[n]);
  std::vector<std::vector<Subset>> by_size;
  std::size_t done = 0, total = 0;
  for (std::size_t hidden = 0; hidden <= hideable.size(); ++hidden) {
    const std::size_t most = hidden > 3 ? settings.max_large_subsets : settings.max_subsets;
    by_size.push_back(subsets_of(hideable, hidden, most, settings.seed));
    total += by_size.back().size();
  }
  Progress progress("hidden inputs", "subsets", total);  // of the first forecaster, the slowest
  std::vector<MissingPoint> curve;
  for (std::size_t hidden = 0; hidden < by_size.size(); ++hidden) {
    const std::vector<Subset>& subsets = by_size[hidden];
    MissingPoint& point = curve.emplace_back(MissingPoint{hidden, subsets.size(), rows.size(), {}});
    MeanTerms first;
    for (const Forecaster& forecaster : forecasters) {
      MeanTerms terms = mean_terms(forecaster, table, rows, label, subsets, [&] {
        if (&forecaster == &forecasters.front()) progress.update(++done);
      });
      MissingPoint::Scored scored{forecaster.name, mean_of(terms.brier), mean_of(terms.log_loss), {}, {}};
      if (point.scored.empty()) {
        first = std::move(terms);
      } else {
        scored.brier_difference = mean_difference(first.brier, terms.brier, settings.seed);
        scored.log_loss_difference = mean_difference(first.log_loss, terms.log_loss, settings.seed);
      }
      point.scored.push_back(std::move(scored));
    }
  }
  return curve;
}

Json to_json(const std::vector<MissingPoint>& curve) {
  Json json = Json::array();
  for (const MissingPoint& point : curve) {
    Json brier = Json::object(), loss = Json::object(), difference = Json::object();
    for (const MissingPoint::Scored& scored : point.scored) {
      brier[scored.name] = scored.brier;
      loss[scored.name] = scored.log_loss;
      if (&scored != &point.scored.front())
        difference[scored.name] = Json::Object{{"brier", interval_json(scored.brier_difference)},
                                               {"log_loss_nat", interval_json(scored.log_loss_difference)}};
    }
    json.push_back(Json::Object{{"hidden", point.hidden},
                                {"subsets", point.subsets},
                                {"trials", point.trials},
                                {"brier", std::move(brier)},
                                {"log_loss_nat", std::move(loss)},
                                {"difference", std::move(difference)}});
  }
  return json;
}

std::string missing_text(const std::vector<MissingPoint>& curve) {
  std::string text = line(
      "Brier score with inputs hidden on %zu trials (the model sums them out, the others take their mean); model "
      "minus the others [95 %%]\n",
      curve.front().trials);
  text += line("%-7s %7s", "hidden", "subsets");
  for (const MissingPoint::Scored& scored : curve.front().scored) text += line(" %20s", scored.name.c_str());
  text += "  minus logistic_regression   minus neural_network\n";
  for (const MissingPoint& point : curve) {
    text += line("%-7zu %7zu", point.hidden, point.subsets);
    for (const MissingPoint::Scored& scored : point.scored) text += line(" %20.4f", scored.brier);
    for (const char* who : {"logistic_regression", "neural_network"})
      for (const MissingPoint::Scored& scored : point.scored) {
        const learning::Interval& d = scored.brier_difference;
        if (scored.name == who) text += line("  %+.4f [%+.4f, %+.4f]", d.value, d.low, d.high);
      }
    text += "\n";
  }
  return text;
}

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

Reconstruction summed_up(const std::vector<Row>& scored, const Predictor& predictor,
                         const std::vector<std::size_t>& varying, std::uint64_t seed) {
  std::vector<double> covered, gain;
  for (const Row& row : scored) {
    Sums all;
    for (const Sums& sums : row) all = {all.covered + sums.covered, all.gain + sums.gain, all.count + sums.count};
    covered.push_back(all.covered / all.count);
    gain.push_back(all.gain / all.count);
  }
  Reconstruction result{.left_out = {},
                        .rows = scored.size(),
                        .pairs = varying.size() * (varying.size() - 1) / 2,
                        .coverage = learning::bootstrap_mean(covered, seed),
                        .gain = learning::bootstrap_mean(gain, seed),
                        .variables = {}};
  for (std::size_t v : varying) {
    Sums all;
    for (const Row& row : scored)
      all = {all.covered + row[v].covered, all.gain + row[v].gain, all.count + row[v].count};
    result.variables.push_back(
        {predictor.model().layout.encoders()[v].name(), all.covered / all.count, all.gain / all.count});
  }
  return result;
}

}  // namespace

Reconstruction reconstruction_scores(const Predictor& predictor, const learning::TrainingTable& table,
                                     const ReconstructionSettings& settings) {
  const learning::Model& model = predictor.model();
  const std::vector<std::size_t> varying = varying_inputs(model.layout);
  const std::vector<std::size_t> rows = whole_rows(table, settings);
  if (varying.size() < 2) return {.left_out = "fewer than two inputs vary", .variables = {}};
  if (rows.empty()) return {.left_out = "every trial has an unknown input", .variables = {}};
  const learning::InputPrior prior =
      model.input_prior.empty() ? learning::uniform_prior(model.layout) : model.input_prior;
  std::vector<Row> scored(rows.size());
  for_each_on_host(rows.size(), 1, [&](std::size_t k) {
    scored[k] = scored_row(predictor, prior, table.row(rows[k]), table.outcome[rows[k]], varying);
  });
  return summed_up(scored, predictor, varying, settings.seed);
}

Json to_json(const Reconstruction& scores) {
  if (!scores.left_out.empty()) return Json::Object{{"left_out", scores.left_out}};
  Json variables = Json::object();
  for (const Reconstruction::Variable& variable : scores.variables)
    variables[variable.name] = Json::Object{{"coverage", variable.coverage}, {"gain_nat", variable.gain}};
  return Json::Object{{"rows", scores.rows},
                      {"pairs", scores.pairs},
                      {"coverage", interval_json(scores.coverage)},
                      {"gain_nat", interval_json(scores.gain)},
                      {"variables", std::move(variables)}};
}

std::string reconstruction_text(const Reconstruction& scores) {
  if (!scores.left_out.empty()) return "no score of reconstruction: " + scores.left_out + "\n";
  std::string text = line(
      "two inputs reconstructed from the outcome and the others (%zu trials, %zu pairs): intervals of 90 %% hold "
      "%.3f [%.3f, %.3f]; log score above the prior's %+.3f [%+.3f, %+.3f] nat\n",
      scores.rows, scores.pairs, scores.coverage.value, scores.coverage.low, scores.coverage.high, scores.gain.value,
      scores.gain.low, scores.gain.high);
  for (const Reconstruction::Variable& variable : scores.variables)
    text += line("  %-24s %.3f  %+.3f\n", variable.name.c_str(), variable.coverage, variable.gain);
  return text;
}

}  // namespace gonogo::outcome
