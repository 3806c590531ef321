// What the texture of a cell may be, given its shares of sand and clay and their errors.
#pragma once
#include <array>
#include <cstdint>

namespace gonogo::map {

/// Parts by texture, in the order of terrain::usda_texture_codes().
using TextureMixture = std::array<std::uint8_t, 12>;

/// Shares by mass [%] and their standard errors.
struct TextureShares {
  double sand = 0, silt = 0, clay = 0;
  double sand_error = 0, clay_error = 0;
};

/// Texture classes at 5 x 5 equally likely points of independent normal errors of sand and clay, kept inside the
/// triangle, rounded to `parts` parts by their largest remainders.
TextureMixture texture_mixture(const TextureShares& shares, int parts);

}  // namespace gonogo::map
