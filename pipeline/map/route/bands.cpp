#include "pipeline/map/route/bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/line.h"

namespace gonogo::map {
namespace {

constexpr double kWantedBands = 8;
constexpr std::array<const char*, 4> kMeaning = {"metres", "seconds", "-ln of the chance to get through", "joules"};

/// The smallest round number that is at least `least`. Seconds are rounded to minutes and hours, other units to 1, 2 or
/// 5 times a power of ten.
double round_interval(RouteCost cost, double least) {
  if (!(least > 0)) return 1;
  if (cost == RouteCost::time)
    for (const double seconds : {60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400})
      if (least > 30 && seconds >= least) return seconds;
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1, 2, 5})
    if (factor * power >= least) return factor * power;
  return 10 * power;
}

struct Scale {
  double size;  // of the unit in unit_of(cost)
  const char* unit;
};

Scale scale_of(RouteCost cost, double interval) {
  switch (cost) {
    case RouteCost::time:
      return interval >= 60 ? Scale{60, " min"} : Scale{1, " s"};
    case RouteCost::energy:
      return interval >= 1e5 ? Scale{1e6, " MJ"} : Scale{1e3, " kJ"};
    case RouteCost::length:
      return interval >= 100 ? Scale{1e3, " km"} : Scale{1, " m"};
    default:
      return {1, ""};
  }
}

std::string label_of(RouteCost cost, double from, double to, const Scale& scale) {
  if (cost == RouteCost::risk) return line("risk %g to %g", from, to);
  return line("%g to %g%s", from / scale.size, to / scale.size, scale.unit);
}

}  // namespace

CostBands cost_bands(RouteCost cost, const std::vector<float>& least, double interval) {
  double most = 0;
  for (const float c : least)
    if (std::isfinite(c)) most = std::max(most, double(c));
  if (!(interval >= 0) || !std::isfinite(interval))
    throw InputError(line("route: --interval: %g is not the width of a band; give a number above 0", interval));
  CostBands bands;
  bands.interval = interval > 0 ? interval : round_interval(cost, most / kWantedBands);
  const double count = std::floor(most / bands.interval) + 1;
  if (count > kMaxBands)
    throw InputError(
        line("route: --interval %g makes %.0f bands up to the largest cost of %.4g (%s); allowed are %d, "
             "so give at least %.3g",
             interval, count, most, kMeaning[std::size_t(cost)], kMaxBands, most / (kMaxBands - 1)));
  const Scale scale = scale_of(cost, bands.interval);
  for (int b = 0; b < int(count); ++b)
    bands.label.push_back(label_of(cost, b * bands.interval, (b + 1) * bands.interval, scale));
  for (const float c : least)
    bands.band.push_back(std::isfinite(c) ? std::uint8_t(std::floor(double(c) / bands.interval)) : kNoBand);
  return bands;
}

LargestRegions largest_regions(const std::vector<std::int32_t>& region) {
  LargestRegions result;
  for (const std::int32_t r : region) {
    if (r < 0) continue;
    if (std::size_t(r) >= result.cells.size()) result.cells.resize(std::size_t(r) + 1);
    ++result.cells[std::size_t(r)];
  }
  std::vector<std::size_t> order(result.cells.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return result.cells[a] > result.cells[b]; });
  std::vector<std::uint8_t> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[order[k]] = std::uint8_t(std::min(k, kMaxRegions));
  for (const std::int32_t r : region) result.rank.push_back(r < 0 ? kNoBand : rank[std::size_t(r)]);
  std::sort(result.cells.begin(), result.cells.end(), std::greater<>());
  return result;
}

}  // namespace gonogo::map
