#include "vehicle/family/common_pull.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"

namespace gonogo::vehicle {
namespace {

constexpr double kAsMuch = 0.05;  // side forces differ by less than a fit of wheel trials errs, as a share

}  // namespace

std::vector<double> axle_loads(std::span<const double> shares) {
  constexpr double kLeast = 0.02;
  std::vector<double> loads;
  for (const double share : shares) loads.push_back(std::max(kLeast, share * double(shares.size())));
  return loads;
}

CommonPull largest_pull(std::span<const double> shares, std::size_t ways, double side,
                        const std::function<AxleForces(std::size_t axle, std::size_t way)>& forces) {
  GONOGO_ASSERT(ways > 0);
  std::vector<AxleForces> sum(ways);
  for (std::size_t way = 0; way < ways; ++way)
    for (std::size_t axle = 0; axle < shares.size(); ++axle) {
      const AxleForces f = forces(axle, way);
      sum[way].pull += shares[axle] * f.pull;
      sum[way].side += shares[axle] * f.side;
    }
  const auto by_side = [](const AxleForces& a, const AxleForces& b) { return a.side < b.side; };
  const double most = std::max_element(sum.begin(), sum.end(), by_side)->side;
  const double needed = std::min(side, most - kAsMuch * std::fabs(most));
  std::size_t best = ways;
  for (std::size_t way = 0; way < ways; ++way)
    if (sum[way].side >= needed && (best == ways || sum[way].pull > sum[best].pull)) best = way;
  return {sum[best].pull, best};
}

}  // namespace gonogo::vehicle
