// How well a design fills the box that it samples.
#pragma once
#include "pipeline/campaign/design/design.h"

namespace gonogo::campaign {

/// Of the first 8192 points of a design, replicates left out, scaled to the unit cube.
struct Coverage {
  double discrepancy = 0;      // star discrepancy in the L2 norm (Warnock)
  double expected_random = 0;  // root mean square of the same for independent uniform points
  double largest_gap = 0;      // largest empty interval of any one-dimensional projection, as a share of the range
  double empty_ball = 0;       // radius of the largest ball around a point of the cube that holds no point of the
                               // design [sides of the cube]; a lower bound, see largest_empty_ball()
};
Coverage coverage(const DesignSpec& spec, const std::vector<DesignPoint>& design);

/// Radius of the largest empty ball with its centre in the unit cube: the best of 4096 Sobol' points, the eight best of
/// which then climb away from their nearest point. A lower bound of the true radius.
double largest_empty_ball(const std::vector<std::vector<double>>& points, std::size_t dimensions);

}  // namespace gonogo::campaign
