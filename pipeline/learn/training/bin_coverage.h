// How well trials cover the bins that a layout tells apart.
#pragma once
#include "learning/encoding/layout.h"
#include "learning/table.h"

namespace gonogo::learn {

struct BinCoverage {
  std::size_t fewest = 0;  // trials in the emptiest bin of any variable
  double empty_pairs = 0;  // share of the pairs of bins of two variables in which no trial lies
};

/// Rows in which a variable is unknown count for the others. A layout without bins to tell apart has all rows in one.
BinCoverage bin_coverage(const learning::VisibleLayout& layout, const learning::TrainingTable& table);

}  // namespace gonogo::learn
