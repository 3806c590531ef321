#include "pipeline/learn/missing_curve.h"

#include <algorithm>
#include <cmath>

#include "base/cancel.h"
#include "learning/score/score.h"

namespace gonogo::pipeline {
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

}  // namespace

Json missing_curve(const std::vector<Forecaster>& forecasters, const learning::TrainingTable& table,
                   std::span<const int> happened, const std::vector<std::size_t>& hideable,
                   const MissingSettings& settings) {
  std::vector<std::size_t> rows = learning::permutation(table.row_count(), settings.seed, 0x726f);
  rows.resize(std::min(rows.size(), settings.most_rows));
  std::vector<int> label;
  for (std::size_t n : rows) label.push_back(happened[n]);
  Json curve = Json::array();
  for (std::size_t hidden = 0; hidden <= hideable.size(); ++hidden) {
    const auto subsets = subsets_of(hideable, hidden, settings.most_subsets, settings.seed);
    Json point, brier = Json::object(), loss = Json::object();
    for (const Forecaster& forecaster : forecasters) {
      double brier_sum = 0, loss_sum = 0;
      for (const Subset& subset : subsets) {
        const std::vector<double> p = forecasts(forecaster, table, rows, subset);
        brier_sum += learning::brier_score(p, label) / double(subsets.size());
        loss_sum += learning::log_loss(p, label) / double(subsets.size());
      }
      brier[forecaster.name] = brier_sum;
      loss[forecaster.name] = loss_sum;
    }
    point["hidden"] = Json(std::uint64_t(hidden));
    point["subsets"] = Json(std::uint64_t(subsets.size()));
    point["trials"] = Json(std::uint64_t(rows.size()));
    point["brier"] = std::move(brier);
    point["log_loss_nat"] = std::move(loss);
    curve.push_back(std::move(point));
  }
  return curve;
}

}  // namespace gonogo::pipeline
