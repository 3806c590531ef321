// How forecasts worsen when inputs are hidden.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/table.h"

namespace gonogo::learn {

/// A forecaster of P(passable) for one row of variables [variable count]; NaN marks an unknown variable.
struct Forecaster {
  std::string name;
  std::function<double(std::span<const double>)> forecast;
};

struct MissingSettings {
  std::size_t max_rows = 1000;        // max rows of the table; drawn from the seed if it has more
  std::size_t max_subsets = 36;       // max subsets of each size, likewise; 36 are all pairs of nine
  std::size_t max_large_subsets = 6;  // the same for sizes above three, which take long
  std::uint64_t seed = 1;
};

/// Scores every forecaster with 0, 1, ... of the `hideable` variables hidden. Scores are means over rows and subsets,
/// which are the same for all forecasters. `happened`: 1 for passable [row]. One entry for each number hidden:
/// { hidden, subsets, trials, brier: {name: x}, log_loss_nat: {name: x},
///   difference: {name: {brier: {value, low, high}, log_loss_nat}} }, the first forecaster minus the named one.
Json missing_curve(const std::vector<Forecaster>& forecasters, const learning::TrainingTable& table,
                   std::span<const int> happened, const std::vector<std::size_t>& hideable,
                   const MissingSettings& settings = {});

}  // namespace gonogo::learn
