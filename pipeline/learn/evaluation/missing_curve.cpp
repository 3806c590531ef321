#include "pipeline/learn/evaluation/missing_curve.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/cancel.h"
#include "learning/score/calibration.h"
#include "pipeline/learn/training/score_report.h"

namespace gonogo::learn {
namespace {

using Subset = std::vector<std::size_t>;

/// All subsets of `size` of the variables in order, or `most` of them drawn by the seed.
std::vector<Subset> subsets_of(const std::vector<std::size_t>& variables, std::size_t size, std::size_t most,
                               std::uint64_t seed) {
  std::vector<Subset> all;
  const std::size_t count = variables.size();
  for (std::size_t mask = 0; mask < std::size_t(1) << count; ++mask) {
    Subset subset;
    for (std::size_t k = 0; k < count; ++k)
      if (mask >> k & 1) subset.push_back(variables[k]);
    if (subset.size() == size) all.push_back(std::move(subset));
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
#pragma omp parallel for schedule(dynamic)
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (cancel_requested()) continue;
    const auto row = table.row(rows[k]);
    std::vector<double> known(row.begin(), row.end());
    for (std::size_t v : hidden) known[v] = NAN;
    p[k] = std::clamp(forecaster.forecast(known), 1e-12, 1 - 1e-12);
  }
  stop_if_cancelled();
  return p;
}

/// Scores of every row, as means over the subsets.
struct MeanTerms {
  std::vector<double> brier, log_loss;
};

MeanTerms mean_terms(const Forecaster& forecaster, const learning::TrainingTable& table,
                     const std::vector<std::size_t>& rows, const std::vector<int>& label,
                     const std::vector<Subset>& subsets) {
  MeanTerms mean{std::vector<double>(rows.size(), 0.0), std::vector<double>(rows.size(), 0.0)};
  const auto add = [&](std::vector<double>& sum, const std::vector<double>& terms) {
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += terms[k] / double(subsets.size());
  };
  for (const Subset& subset : subsets) {
    const std::vector<double> p = forecasts(forecaster, table, rows, subset);
    add(mean.brier, learning::brier_terms(p, label));
    add(mean.log_loss, learning::log_loss_terms(p, label));
  }
  return mean;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

}  // namespace

Json missing_curve(const std::vector<Forecaster>& forecasters, const learning::TrainingTable& table,
                   std::span<const int> happened, const std::vector<std::size_t>& hideable,
                   const MissingSettings& settings) {
  std::vector<std::size_t> rows = learning::permutation(table.row_count(), settings.seed, 0x726f);
  rows.resize(std::min(rows.size(), settings.max_rows));
  std::vector<int> label;
  for (std::size_t n : rows) label.push_back(happened[n]);
  Json curve = Json::array();
  for (std::size_t hidden = 0; hidden <= hideable.size(); ++hidden) {
    const std::size_t most = hidden > 3 ? settings.max_large_subsets : settings.max_subsets;
    const auto subsets = subsets_of(hideable, hidden, most, settings.seed);
    Json point, brier = Json::object(), loss = Json::object(), difference = Json::object();
    std::vector<MeanTerms> terms;
    for (const Forecaster& forecaster : forecasters) {
      terms.push_back(mean_terms(forecaster, table, rows, label, subsets));
      brier[forecaster.name] = mean_of(terms.back().brier);
      loss[forecaster.name] = mean_of(terms.back().log_loss);
    }
    for (std::size_t f = 1; f < forecasters.size(); ++f) {
      Json scores;
      scores["brier"] = difference_json(terms[0].brier, terms[f].brier, settings.seed);
      scores["log_loss_nat"] = difference_json(terms[0].log_loss, terms[f].log_loss, settings.seed);
      difference[forecasters[f].name] = std::move(scores);
    }
    point["hidden"] = Json(std::uint64_t(hidden));
    point["subsets"] = Json(std::uint64_t(subsets.size()));
    point["trials"] = Json(std::uint64_t(rows.size()));
    point["brier"] = std::move(brier);
    point["log_loss_nat"] = std::move(loss);
    point["difference"] = std::move(difference);
    curve.push_back(std::move(point));
  }
  return curve;
}

}  // namespace gonogo::learn
