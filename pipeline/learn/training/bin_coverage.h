// How well trials cover the bins of a layout.
#pragma once
#include "learning/encoding/layout.h"
#include "learning/table.h"

namespace gonogo::learn {

struct BinCoverage {
  std::size_t fewest = 0;  // trials in the emptiest bin of any variable
  double empty_pairs = 0;  // share of the pairs of bins of two variables without a trial
};

/// A row with an unknown variable counts for its other variables. In a layout without inner edges all rows share one
/// bin.
BinCoverage bin_coverage(const learning::VisibleLayout& layout, const learning::TrainingTable& table);

}  // namespace gonogo::learn
