// How well a design fills the box that it samples.
#pragma once
#include "pipeline/campaign/design/design.h"

namespace gonogo::campaign {

/// Of the first 8192 points of a design without replicates, scaled to the unit cube.
struct Coverage {
  double discrepancy = 0;      // star discrepancy in the L2 norm (Warnock)
  double expected_random = 0;  // root mean square of the same for independent uniform points
  double largest_gap = 0;      // largest empty interval of any one-dimensional projection, as a share of the range
  double empty_ball = 0;       // largest_empty_ball() [sides of the cube]
};
Coverage coverage(const DesignSpec& spec, const std::vector<DesignPoint>& design);

/// Radius of the largest ball with its centre in the unit cube that holds no point: a lower bound. The eight best of
/// 4096 Sobol' points climb away from their nearest points, and the best of them counts.
double largest_empty_ball(const std::vector<std::vector<double>>& points, std::size_t dimensions);

}  // namespace gonogo::campaign
