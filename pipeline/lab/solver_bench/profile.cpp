#include "pipeline/lab/solver_bench/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonogo::lab {

Profile performance_profile(const std::vector<std::vector<double>>& cost) {
  Profile profile;
  std::vector<std::vector<double>> ratio = cost;
  const std::size_t problems = cost.empty() ? 0 : cost[0].size();
  profile.tau = {1};
  for (std::size_t p = 0; p < problems; ++p) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& of_solver : cost) least = std::min(least, of_solver[p]);
    for (auto& of_solver : ratio) {
      of_solver[p] = std::isfinite(of_solver[p]) ? of_solver[p] / least : std::numeric_limits<double>::infinity();
      if (std::isfinite(of_solver[p])) profile.tau.push_back(of_solver[p]);
    }
  }
  std::sort(profile.tau.begin(), profile.tau.end());
  profile.tau.erase(std::unique(profile.tau.begin(), profile.tau.end()), profile.tau.end());
  for (const auto& of_solver : ratio) {
    std::vector<double> share;
    for (const double tau : profile.tau)
      share.push_back(double(std::count_if(of_solver.begin(), of_solver.end(), [&](double x) { return x <= tau; })) /
                      double(problems));
    profile.share.push_back(share);
  }
  return profile;
}

}  // namespace gonogo::lab
