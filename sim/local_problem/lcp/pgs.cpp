#include <algorithm>

#include "base/cancel.h"
#include "sim/local_problem/lcp/lcp.h"

namespace gonogo::sim {

LcpSolution solve_pgs(const Lcp& lcp, const LcpSettings& settings, const Eigen::VectorXd& start) {
  constexpr int kCheckEvery = 10;  // sweeps; an error costs as much as a sweep
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 20000;
  const Eigen::VectorXd diagonal = lcp.m.diagonal();
  LcpSolution best;
  best.x = start.size() > 0 ? start : Eigen::VectorXd(Eigen::VectorXd::Zero(lcp.size()));
  best.error = natural_error(lcp, best.x);
  Eigen::VectorXd x = best.x;
  int k = 0;
  while (k < max && best.error > settings.tolerance) {
    stop_if_cancelled();
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (diagonal[i] > 0) x[i] = std::max(0.0, x[i] - (lcp.m.row(i).dot(x) + lcp.q[i]) / diagonal[i]);
    if (++k % kCheckEvery != 0 && k != max) continue;
    const double error = natural_error(lcp, x);
    if (error >= best.error) continue;
    best.error = error;
    best.x = x;
  }
  best.iterations = k;
  best.status = best.error <= settings.tolerance ? LcpStatus::solved : LcpStatus::iterations;
  return best;
}

}  // namespace gonogo::sim
