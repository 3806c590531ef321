#include "sim/elastic/tyre/tread.h"

#include <algorithm>

namespace gonogo::sim::elastic {

LossyTread::LossyTread(int nodes, double stiffness, const Rubber& rubber)
    : stiffness_(stiffness),
      rubber_(rubber),
      compression_(std::size_t(nodes), 0.0),
      pressing_(std::size_t(nodes), 0.0),
      stretched_(std::size_t(nodes)) {}

double LossyTread::follow(const std::vector<double>& gap, double h) {
  std::array<Fading, kBranches> fading{};
  for (int b = 0; b < kBranches; ++b) fading[b] = fading_of(kRate[b], h);
  double lost = 0;
  for (std::size_t k = 0; k < gap.size(); ++k) {
    std::array<double, kBranches>& d = stretched_[k];
    if (!(gap[k] < 0) && compression_[k] == 0 && d == std::array<double, kBranches>{}) continue;
    double held = 0, follows = 1;  // of s + g sum d: with s as before, and its slope by s
    for (int b = 0; b < kBranches; ++b) {
      held += rubber_.branch * (fading[b].kept * d[b] - fading[b].taken * compression_[k]);
      follows += rubber_.branch * fading[b].taken;
    }
    const double free = -held / follows, s = std::max(-gap[k], free);
    for (int b = 0; b < kBranches; ++b) {
      const double before = d[b];
      d[b] = fading[b].kept * d[b] + fading[b].taken * (s - compression_[k]);
      lost += rubber_.branch * kRate[b] * h / 2 * (before * before + d[b] * d[b]);
    }
    compression_[k] = s;
    pressing_[k] = s > free ? rubber_.settled * (held + follows * s) : 0;
  }
  return rubber_.settled * stiffness_ * lost;
}

double LossyTread::energy() const {
  double sum = 0;
  for (std::size_t k = 0; k < compression_.size(); ++k) {
    sum += compression_[k] * compression_[k];
    for (const double d : stretched_[k]) sum += rubber_.branch * d * d;
  }
  return rubber_.settled * stiffness_ * sum / 2;
}

}  // namespace gonogo::sim::elastic
