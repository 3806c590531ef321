// Which trials of a dataset a model of a learning curve is trained on.
#pragma once
#include <cstdint>
#include <vector>

#include "learning/table.h"
#include "pipeline/learn/active/choose.h"

namespace gonogo::learn {

/// Groups of replicates that an active design takes from the table: `taken` and, drawn one after the other from the
/// rest, as many as it needs for `count` rows or a few more. A group's chance is in proportion to the density of
/// choose_batch() at its point, by `model`, with its default share of space filling. Ascending.
std::vector<std::uint64_t> grown_groups(const learning::TrainingTable& table, const std::vector<std::uint64_t>& taken,
                                        std::size_t count, const ModelAnswers& model, std::uint64_t seed);

}  // namespace gonogo::learn
