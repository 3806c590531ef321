#include "pipeline/map/region/spread.h"

#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "pipeline/campaign/study/task_variables.h"

namespace gonogo::map {
namespace {

Spread read_spread(const Config& config, const campaign::Variable& variable) {
  const Range allowed = {variable.minimum, variable.maximum};
  Spread spread;
  if (int(config.has("fixed")) + int(config.has("range")) + int(config.has("unknown")) != 1)
    config.fail("", "expected exactly one of \"fixed\", \"range\" and \"unknown\"");
  if (config.has("unknown")) {
    spread.source = config.text("unknown");
  } else if (config.has("fixed")) {
    spread.kind = Spread::Kind::fixed;
    spread.low = spread.high = config.number("fixed", allowed);
    spread.source = config.text("source");
  } else {
    const std::vector<double> range = config.numbers("range", allowed);
    if (range.size() != 2 || !(range[0] < range[1])) config.fail("range", "expected [low, high]");
    spread = {Spread::Kind::range, range[0], range[1], config.text("source")};
  }
  config.finish();
  return spread;
}

/// Digits of `index` in `base`, mirrored at the point (van der Corput).
double radical_inverse(int index, int base) {
  double value = 0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) value += digit * (index % base);
  return value;
}

}  // namespace

Spreads read_spreads(const Config& config) {
  Spreads spreads;
  for (const auto& [name, member] : config.members()) {
    if (name == "slope_along" || name == "slope_across")
      config.fail(name, "slopes come from the elevation raster; remove this key");
    spreads[name] = read_spread(member, campaign::contract().variables[campaign::contract().variable_index(name)]);
  }
  return spreads;
}

std::vector<std::vector<double>> spread_points(const Spreads& spreads, int draws, int shift) {
  constexpr std::array<int, 10> kPrimes = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29};
  const auto& variables = campaign::contract().variables;
  int ranges = 0;
  for (const auto& [name, spread] : spreads) ranges += spread.kind == Spread::Kind::range;
  if (ranges > int(kPrimes.size()))
    throw InputError("more ranges than the map can sample; fix some of these variables");
  std::vector<std::vector<double>> points(
      std::size_t(ranges > 0 ? draws : 1),
      std::vector<double>(variables.size(), std::numeric_limits<double>::quiet_NaN()));
  int dimension = 0;
  for (std::size_t v = 0; v < variables.size(); ++v) {
    if (campaign::is_task_variable(variables[v]))
      for (std::vector<double>& point : points) point[v] = 0;
    const auto found = spreads.find(variables[v].name);
    if (found == spreads.end() || found->second.kind == Spread::Kind::unknown) continue;
    const Spread& spread = found->second;
    const bool ranged = spread.kind == Spread::Kind::range;
    for (int i = 0; i < int(points.size()); ++i) {
      double share = !ranged          ? 0
                     : dimension == 0 ? (i + 0.5) / draws
                                      : radical_inverse(i + 1, kPrimes[std::size_t(dimension) - 1]);
      if (ranged && shift > 0)
        share = std::fmod(share + shift * std::sqrt(double(kPrimes[std::size_t(dimension)])), 1.0);
      points[std::size_t(i)][v] = spread.low + (spread.high - spread.low) * share;
    }
    dimension += ranged;
  }
  return points;
}

}  // namespace gonogo::map
