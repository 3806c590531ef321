// Training data: one row per valid trial.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace gonogo::learning {

struct TrainingTable {
  std::size_t variable_count = 0;
  std::vector<double> variables;     // [row_count() x variable_count], NaN: unknown
  std::vector<std::size_t> outcome;  // [row_count()], index in the layout's outcomes
  std::vector<double> weight;        // [row_count()], > 0: prior / proposal density of the row
  std::vector<std::uint64_t> group;  // [row_count()]: rows of one group (replicates) stay in one fold

  std::size_t row_count() const { return outcome.size(); }
  std::span<const double> row(std::size_t i) const {
    return std::span(variables).subspan(i * variable_count, variable_count);
  }
  TrainingTable subset(const std::vector<std::size_t>& rows) const;
};

/// Random fold 0 .. fold_count - 1 of every row. Folds have equal sizes; a group is in one fold.
std::vector<std::size_t> assign_folds(const TrainingTable& table, std::size_t fold_count, std::uint64_t seed);

/// A fixed permutation of 0 .. count - 1 for (seed, stream).
std::vector<std::size_t> permutation(std::size_t count, std::uint64_t seed, std::uint64_t stream);

}  // namespace gonogo::learning
