// What can be reached, in few numbers: bands of equal cost (isochrones) and the largest connected regions.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/map/route/cost.h"

namespace gonogo::map {

inline constexpr std::uint8_t kNoBand = 255;
inline constexpr int kMostBands = 250;

/// Bands of equal cost, `interval` [unit_of(cost)] wide: band b holds b interval <= cost < (b + 1) interval.
struct CostBands {
  double interval = 0;
  std::vector<std::string> label;  // [band] "10 to 20 min"
  std::vector<std::uint8_t> band;  // [cell]; kNoBand where there is no way
};

/// An interval of 0 becomes the least round one that gives at most eight bands. Throws InputError where it is negative,
/// not finite, or gives more than kMostBands.
CostBands cost_bands(RouteCost cost, const std::vector<float>& least, double interval);

inline constexpr std::size_t kLargestRegions = 20;

struct LargestRegions {
  std::vector<std::uint8_t> rank;    // [cell] 0 in the largest region; kLargestRegions in smaller ones; kNoBand outside
  std::vector<std::uint64_t> cells;  // of every region, the largest first
};

/// From what connected_regions gives; of equally large regions the one with the first cell comes first.
LargestRegions largest_regions(const std::vector<std::int32_t>& region);

}  // namespace gonogo::map
