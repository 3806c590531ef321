// Sobol' sequence and its Owen scrambling.
#pragma once
#include <cstdint>

namespace gonogo::campaign {

/// Dimensions that there are direction numbers for.
inline constexpr int kSobolDimensions = 21;

/// Coordinate `dimension` of point `index` of the Sobol' sequence in Gray-code order, as the fraction result / 2^32.
/// Direction numbers: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections",
/// SIAM J. Sci. Comput. 30 (2008), file new-joe-kuo-6.21201. Every first 2^k points are one point per interval 1/2^k in
/// each dimension. Needs 0 <= dimension < kSobolDimensions and index < 2^32.
std::uint32_t sobol(std::uint32_t index, int dimension);

/// Nested uniform scrambling (A. B. Owen, "Randomly permuted (t,m,s)-nets and (t,s)-sequences", 1995): each half of
/// each interval of the binary tree over [0, 1) swaps with the other at random. Hash-based form: B. Burley, "Practical
/// hash-based Owen scrambling", JCGT 9(4) (2020), section 3. Philox hashes (seed, dimension, node of the tree), so that
/// the swaps are independent to the last bit.
std::uint32_t owen_scramble(std::uint32_t fraction, std::uint64_t seed, int dimension);

/// Scrambled coordinate in (0, 1): middle of its interval of width 1/2^32.
double scrambled_sobol(std::uint32_t index, std::uint64_t seed, int dimension);

}  // namespace gonogo::campaign
