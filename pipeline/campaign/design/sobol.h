// Points that fill a box: Sobol' sequence with Owen scrambling, and how well a design covers its ranges.
#pragma once
#include <cstdint>

#include "pipeline/campaign/design/design.h"

namespace gonogo::campaign {

/// Dimensions that there are direction numbers for.
inline constexpr int kSobolDimensions = 37;

/// Coordinate `dimension` of point `index` of the Sobol' sequence in Gray-code order, as the fraction result / 2^32.
/// Direction numbers: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections",
/// SIAM J. Sci. Comput. 30 (2008), file new-joe-kuo-6.21201. Every first 2^k points are one point per interval 1/2^k in
/// each dimension. Needs 0 <= dimension < kSobolDimensions and index < 2^32.
std::uint32_t sobol(std::uint32_t index, int dimension);

/// Scrambled coordinate in (0, 1): middle of its interval of width 1/2^32.
double scrambled_sobol(std::uint32_t index, std::uint64_t seed, int dimension);

/// How well the first 8192 points of a design, without replicates, fill the box that it samples, scaled to the unit
/// cube.
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
