// Visits all combinations of bins of several variables. The last variable changes fastest, so that results of the first
// ones are computed once for all combinations that share them.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace gonogo::learning {

/// bins: number of bins of each variable, at least 1. For every combination calls set(k, bin) for the first variable k
/// that changed and all after it, in order, then visit().
template <class Set, class Visit>
void for_each_combination(std::span<const std::size_t> bins, Set&& set, Visit&& visit) {
  std::vector<std::size_t> bin(bins.size(), 0);
  for (std::size_t k = 0;;) {
    for (; k < bins.size(); ++k) set(k, bin[k]);
    visit();
    while (k > 0 && ++bin[k - 1] == bins[k - 1]) bin[--k] = 0;
    if (k == 0) return;
    --k;
  }
}

}  // namespace gonogo::learning
