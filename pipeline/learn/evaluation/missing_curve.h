// How forecasts get worse when inputs are taken away.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/table.h"

namespace gonogo::learn {

/// P(passable) of one row, unknown variables not-a-number.
struct Forecaster {
  std::string name;
  std::function<double(std::span<const double>)> forecast;
};

struct MissingSettings {
  std::size_t max_rows = 1000;        // of the table, drawn by the seed
  std::size_t max_subsets = 36;       // of every size, drawn by the seed when there are more: all pairs of nine
  std::size_t max_large_subsets = 6;  // the same of sizes above three, whose answers take long
  std::uint64_t seed = 1;
};

/// For 0, 1, ... of the `hideable` variables hidden: Brier score and log loss of every forecaster, means over rows and
/// subsets, the same for all, and how far the first forecaster differs from the others. One object { hidden, subsets,
/// trials, brier: {name: x}, log_loss_nat: {name: x}, difference: {name: {brier: {value, low, high}, log_loss_nat}} }
/// for each.
Json missing_curve(const std::vector<Forecaster>& forecasters, const learning::TrainingTable& table,
                   std::span<const int> happened, const std::vector<std::size_t>& hideable,
                   const MissingSettings& settings = {});

}  // namespace gonogo::learn
