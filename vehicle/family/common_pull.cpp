#include "vehicle/family/common_pull.h"

#include <algorithm>
#include <vector>

#include "base/error.h"

namespace gonogo::vehicle {

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
  std::size_t best = 0;
  for (std::size_t way = 1; way < ways; ++way) {
    const bool holds = sum[way].side >= side, best_holds = sum[best].side >= side;
    if (holds && best_holds ? sum[way].pull > sum[best].pull : sum[way].side > sum[best].side && !best_holds)
      best = way;
  }
  return {sum[best].pull, best};
}

}  // namespace gonogo::vehicle
