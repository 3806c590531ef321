#include "sim/local_problem/lcp/lcp.h"

#include <algorithm>

namespace gonogo::sim {

double natural_error(const Lcp& lcp, const Eigen::VectorXd& x) {
  return x.cwiseMin(lcp.m * x + lcp.q).norm() / std::max(lcp.q.norm(), 1e-300);
}

}  // namespace gonogo::sim
