// Rows of variables and outcome from a CSV file, as gonogo sample and gonogo qubo import write them.
#pragma once
#include <filesystem>

#include "learning/table.h"

namespace gonogo::learn {

/// Columns by the header: variables of the contract, "outcome", and "occurrences" and "weight", whose product weighs a
/// row. Variables without a column are unknown (NaN), rows of weight 0 are left out, other columns count for nothing.
/// Throws InputError for a file without an outcome or without rows, and for cells that are no number or no outcome.
learning::TrainingTable read_given_rows(const std::filesystem::path& file);

}  // namespace gonogo::learn
