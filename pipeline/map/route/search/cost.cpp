#include "pipeline/map/route/search/cost.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/units.h"

namespace gonogo::map {
namespace {

constexpr std::array<const char*, 4> kNames = {"shortest", "fastest", "safest", "least-energy"};

const SlopeMeasure& require_measure(const SoilResponse& soil, const char* name) {
  const auto found = soil.measures().find(name);
  if (found == soil.measures().end())
    throw InputError(std::string("route: the model has no fit of ") + name +
                     "; give the trials with --dataset, or ask for the shortest or the safest way");
  return found->second;
}

void require_speed(const SoilResponse& soil) {
  if (!soil.has_speed())
    throw InputError(
        "route: the model gives no top speed, because its trials or the driveline of its vehicle are not known; give "
        "the trials with --dataset, name the whole vehicle of a quarter with --whole-vehicle, or ask for the shortest "
        "or "
        "the safest way");
}

/// At node (along, across) of the soil's heading table.
double cost_per_metre(const SoilResponse& soil, int along, int across, RouteCost cost, double correlation_length) {
  const BedSlopes slopes = soil.headings().slopes(along, across);
  const double length = 1 / std::cos(slopes.along * kDegree);
  switch (cost) {
    case RouteCost::time:
      require_speed(soil);
      return length / soil.heading_speed(along, across);
    case RouteCost::risk:
      return -std::log(std::min(1.0, double(soil.headings().node(along, across).p_go))) * length / correlation_length;
    case RouteCost::energy:
      return length * std::max(0.0, require_measure(soil, "energy_per_metre").at(slopes));
    default:
      return length;
  }
}

}  // namespace

RouteCost route_cost_named(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (name == kNames[i]) return kRouteCosts[i];
  throw InputError("route: there is no cost \"" + name + "\"; use fastest, safest, least-energy or shortest");
}

std::string name_of(RouteCost cost) { return kNames[std::size_t(cost)]; }

const char* unit_of(RouteCost cost) {
  constexpr std::array<const char*, 4> kUnits = {"m", "s", "1", "J"};
  return kUnits[std::size_t(cost)];
}

std::array<RouteStep, 8> route_steps(double cell_width, double cell_height) {
  std::array<RouteStep, 8> steps = {{{0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}}};
  for (RouteStep& step : steps) {
    const double east = step.column * cell_width, north = -step.row * cell_height;
    step.heading = (int(std::lround(std::atan2(east, north) / kDegree)) + 360) % 360;
    step.length = std::hypot(east, north);
  }
  return steps;
}

HeadingNodes::HeadingNodes(const HeadingTable& table) : node_((std::size_t(90 * kSlopeSteps) + 1) * 360) {
  const int steps = int(90 * kSlopeSteps) + 1;
  GONOGO_ASSERT(std::size_t(table.along_count()) * std::size_t(table.across_count()) < kNoNode);
  std::vector<FallLine> lines;
  for (int psi = 0; psi < 360; ++psi) lines.emplace_back(psi * kDegree);
  for_each_on_host(std::size_t(steps), 16, [&](std::size_t s) {
    const double rise = std::tan(double(s) / kSlopeSteps * kDegree);
    for (std::size_t psi = 0; psi < lines.size(); ++psi)
      node_[s * 360 + psi] = std::uint16_t(table.index_of(bed_slopes(rise, lines[psi])));  // -1 becomes kNoNode
  });
}

RouteCosts::RouteCosts(const SoilTable& table, RouteCost cost, double correlation_length)
    : nodes_(table.responses.front().headings()) {
  for (const SoilResponse& soil : table.responses) {
    const HeadingTable& headings = soil.headings();
    std::vector<float> factor;
    for (int i = 0; i < headings.along_count(); ++i)
      for (int j = 0; j < headings.across_count(); ++j) {
        const bool passes = campaign::passes(headings.node(i, j).result.verdict);
        factor.push_back(passes ? float(cost_per_metre(soil, i, j, cost, correlation_length)) : kImpassable);
      }
    for (const float f : factor) least_ = std::min(least_, f);
    factor_.push_back(std::move(factor));
    std::vector<char> best;
    for (int s = 0; s <= int(90 * kSlopeSteps); ++s)
      best.push_back(campaign::passes(soil.at(s / kSlopeSteps).headings.best.verdict));
    best_.push_back(std::move(best));
  }
}

PackedCells::PackedCells(const RouteCells& cells, const RouteCosts& costs) : costs_(costs), word_(cells.soil.size()) {
  static_assert(90 * kSlopeSteps < kSlopes);
  for_each_on_host(word_.size(), kCellsAtOnce, [&](std::size_t c) {
    const std::uint32_t row = cells.soil[c] * kSlopes + cells.slope[c];
    word_[c] = std::uint32_t(costs.ever_passable(cells, c)) << 31 | row * kAspects | cells.aspect[c];
  });
  std::vector<char> met(costs.soil_count() * kSlopes);
  for (std::size_t c = 0; c < word_.size(); ++c)
    if (passable(c)) met[row(word_[c])] = 1;
  least_.assign(met.size(), RouteCosts::kImpassable);
  for_each_on_host(met.size(), kCellsAtOnce, [&](std::size_t r) {
    if (met[r]) least_[r] = costs.least_per_metre(std::uint8_t(r / kSlopes), std::uint16_t(r % kSlopes));
  });
}

}  // namespace gonogo::map
