#include "pipeline/map/evaluate/speed_curve.h"

#include <algorithm>
#include <cmath>

#include "base/line.h"
#include "base/units.h"

namespace gonogo::map {

int SpeedCurve::step_of(double speed) {
  if (!(speed > 0)) return 0;
  return std::clamp(int(std::lround(speed / kStep)), 1, kSteps - 1);
}

std::string SpeedCurve::csv() const {
  std::uint64_t known = 0;
  for (const std::uint64_t cells : cells_) known += cells;
  std::string text = "percent_of_known_area,slowest_km_h,mean_km_h\n";
  std::uint64_t taken = 0;
  double time = 0;  // over the cells taken so far, one metre in each
  int step = kSteps - 1;
  std::uint64_t left = cells_[std::size_t(step)];
  for (int percent = 1; percent <= 100 && known > 0; ++percent) {
    const std::uint64_t wanted = std::max<std::uint64_t>(1, known * std::uint64_t(percent) / 100);
    while (taken < wanted) {
      while (left == 0) left = cells_[std::size_t(--step)];
      const std::uint64_t some = std::min(left, wanted - taken);
      time += step > 0 ? double(some) / (step * kStep) : INFINITY;
      taken += some;
      left -= some;
    }
    text += line("%d,%.2f,%.4f\n", percent, kKmPerHour * step * kStep,
                 std::isinf(time) ? 0.0 : kKmPerHour * double(taken) / time);
  }
  const std::uint64_t all = known + unknown_;
  return text + line("unknown,%.6f of all cells,\n", all > 0 ? double(unknown_) / double(all) : 0.0);
}

}  // namespace gonogo::map
