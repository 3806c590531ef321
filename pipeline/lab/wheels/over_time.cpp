#include "pipeline/lab/wheels/over_time.h"

#include <algorithm>

namespace gonogo::lab {

std::vector<double> slip_over_time(const std::vector<Way>& ways, double speed) {
  std::size_t seconds = 0, trials = 0;
  for (const Way& w : ways) {
    if (w.x.empty()) continue;
    seconds = trials == 0 ? w.x.size() - 1 : std::min(seconds, w.x.size() - 1);
    ++trials;
  }
  std::vector<double> slip(seconds, 0);
  for (const Way& w : ways)
    for (std::size_t i = 0; i < seconds && !w.x.empty(); ++i)
      slip[i] += (1 - (w.x[i + 1] - w.x[i]) / speed) / double(trials);
  return slip;
}

}  // namespace gonogo::lab
