#include "pipeline/learn/training/bin_coverage.h"

#include <algorithm>
#include <cmath>

namespace gonogo::learn {

BinCoverage bin_coverage(const learning::VisibleLayout& layout, const learning::TrainingTable& table) {
  const auto& encoders = layout.encoders();
  std::vector<std::vector<int>> bin(encoders.size());  // [variable][row], -1 where unknown
  BinCoverage coverage{table.row_count(), 0};
  for (std::size_t v = 0; v < encoders.size(); ++v) {
    std::vector<std::size_t> count(std::size_t(encoders[v].bin_count()), 0);
    for (std::size_t n = 0; n < table.row_count(); ++n) {
      const double x = table.row(n)[v];
      bin[v].push_back(std::isnan(x) ? -1 : encoders[v].bin_of(x));
      if (bin[v].back() >= 0) ++count[std::size_t(bin[v].back())];
    }
    if (count.size() > 1) coverage.fewest = std::min(coverage.fewest, *std::min_element(count.begin(), count.end()));
  }
  double pairs = 0, met = 0;
  for (std::size_t a = 0; a < encoders.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const auto wide = std::size_t(encoders[b].bin_count());
      if (encoders[a].bin_count() < 2 || wide < 2) continue;
      std::vector<char> seen(std::size_t(encoders[a].bin_count()) * wide, 0);
      for (std::size_t n = 0; n < table.row_count(); ++n)
        if (bin[a][n] >= 0 && bin[b][n] >= 0) seen[std::size_t(bin[a][n]) * wide + std::size_t(bin[b][n])] = 1;
      pairs += double(seen.size());
      met += double(std::count(seen.begin(), seen.end(), 1));
    }
  if (pairs > 0) coverage.empty_pairs = 1 - met / pairs;
  return coverage;
}

}  // namespace gonogo::learn
