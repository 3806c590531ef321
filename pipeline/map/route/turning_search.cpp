#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "base/cancel.h"
#include "pipeline/map/route/any_angle.h"
#include "pipeline/map/route/line_step.h"
#include "pipeline/map/route/turning.h"

namespace gonogo::map {
namespace {

constexpr int kDirections = 32;
constexpr float kImpassable = RouteCosts::kImpassable;

/// How a state was reached.
enum Arrival : std::uint8_t { kStart, kDriven, kClockwise, kCounterclockwise, kNextLeg };

/// The states of a cell on one leg.
struct States {
  std::array<float, kDirections> cost;
  std::array<Arrival, kDirections> arrival;
};

class TurningSearch {
 public:
  TurningSearch(const RouteCells& cells, const RouteCosts& costs, const Turning& turning,
                const std::vector<std::uint32_t>& stops)
      : cells_(cells), costs_(costs), turning_(turning), stops_(stops), steps_(line_steps(cells, false)) {
    std::sort(steps_.begin(), steps_.end(), [](auto& a, auto& b) { return a.heading < b.heading; });
    for (std::size_t leg = 0; leg < legs(); ++leg)
      remaining_.push_back(reach_any_angle(cells, costs, stops[leg + 1], true));
    for (std::size_t leg = legs() - 1; leg-- > 0;) {  // and all later legs
      const float later = remaining_[leg + 1][stops[leg + 1]];
      for (float& r : remaining_[leg]) r += later;
    }
    place_.assign(legs() * cells.soil.size(), kNone);
    passable_.resize(cells.soil.size());
    for (std::size_t c = 0; c < passable_.size(); ++c) passable_[c] = costs.ever_passable(cells, c);
  }

  std::optional<FoundRoute> run() {
    for (int d = 0; d < kDirections; ++d) offer({0, stops_[0], d}, 0, kStart);
    for (std::size_t taken = 0; !queue_.empty(); ++taken) {
      const Entry next = queue_.top();
      queue_.pop();
      if ((taken & 0xffff) == 0) stop_if_cancelled();
      const State state = state_of(next.number);
      const float cost = states(state).cost[std::size_t(state.direction)];
      if (next.least > cost + remaining_[state.leg][state.cell]) continue;  // offered again since
      if (state.cell == stops_[state.leg + 1]) {
        if (state.leg + 1 == legs()) return way_to(state, cost);
        offer({state.leg + 1, state.cell, state.direction}, cost, kNextLeg);
      }
      turn_and_drive(state, cost);
    }
    return std::nullopt;
  }

 private:
  static constexpr std::uint32_t kNone = std::uint32_t(-1);

  struct State {
    std::size_t leg;
    std::uint32_t cell;
    int direction;
  };
  /// Of equal sums the smaller number comes first.
  struct Entry {
    float least;  // cost of a whole way over the state is no less
    std::uint64_t number;
    bool operator>(const Entry& other) const {
      return least != other.least ? least > other.least : number > other.number;
    }
  };

  std::size_t legs() const { return stops_.size() - 1; }
  std::uint64_t number_of(const State& s) const {
    return (s.leg * cells_.soil.size() + s.cell) * kDirections + std::uint64_t(s.direction);
  }
  State state_of(std::uint64_t number) const {
    const std::uint64_t cell = number / kDirections;
    return {std::size_t(cell / cells_.soil.size()), std::uint32_t(cell % cells_.soil.size()),
            int(number % kDirections)};
  }
  States& states(const State& s) {
    std::uint32_t& place = place_[s.leg * cells_.soil.size() + s.cell];
    if (place == kNone) {
      place = std::uint32_t(found_.size());
      found_.emplace_back().cost.fill(kImpassable);
    }
    return found_[place];
  }

  void offer(const State& s, float cost, Arrival arrival) {
    const float least = cost + remaining_[s.leg][s.cell];
    if (!std::isfinite(least)) return;
    States& there = states(s);
    if (!(cost < there.cost[std::size_t(s.direction)])) return;
    there.cost[std::size_t(s.direction)] = cost;
    there.arrival[std::size_t(s.direction)] = arrival;
    queue_.push({least, number_of(s)});
  }

  void turn_and_drive(const State& s, float cost) {
    const std::vector<int>& heading = turning_.directions();
    for (const auto& [next, arrival] : {std::pair((s.direction + 1) % kDirections, kClockwise),
                                        {(s.direction + kDirections - 1) % kDirections, kCounterclockwise}}) {
      const int from = heading[std::size_t(s.direction)], to = heading[std::size_t(next)];
      const int degrees = arrival == kClockwise ? (to - from + 360) % 360 : (from - to + 360) % 360;
      offer({s.leg, s.cell, next}, cost + float(turning_.piece(s.cell, from, to, degrees)), arrival);
    }
    const LineStep& step = steps_[std::size_t(s.direction)];
    const int x = int(s.cell) % cells_.columns + step.column, y = int(s.cell) / cells_.columns + step.row;
    if (x < 0 || y < 0 || x >= cells_.columns || y >= cells_.rows) return;
    const auto beside = [&](std::ptrdiff_t offset) { return std::size_t(std::ptrdiff_t(s.cell) + offset); };
    if (!passable_[beside(step.offset)]) return;
    for (int k = 0; k < step.corners; ++k)
      if (!passable_[beside(step.corner[std::size_t(k)])]) return;
    offer({s.leg, std::uint32_t(beside(step.offset)), s.direction},
          step.add_cost(cells_, costs_, s.cell, cost, kImpassable), kDriven);
  }

  State before(const State& s, Arrival arrival) const {
    if (arrival == kDriven)
      return {s.leg, std::uint32_t(std::ptrdiff_t(s.cell) - steps_[std::size_t(s.direction)].offset), s.direction};
    if (arrival == kNextLeg) return {s.leg - 1, s.cell, s.direction};
    return {s.leg, s.cell, (s.direction + (arrival == kClockwise ? kDirections - 1 : 1)) % kDirections};
  }

  /// Stops and corners of the way to a state.
  FoundRoute way_to(State s, float cost) {
    FoundRoute route{double(cost), {s.cell}};
    int direction = -1;  // of the line that leaves the last corner
    for (Arrival arrival; (arrival = states(s).arrival[std::size_t(s.direction)]) != kStart; s = before(s, arrival)) {
      const bool corner = arrival == kDriven && direction >= 0 && s.direction != direction;
      if ((corner || arrival == kNextLeg) && route.cell.back() != s.cell) route.cell.push_back(s.cell);
      if (arrival == kDriven) direction = s.direction;
    }
    if (route.cell.back() != s.cell || route.cell.size() == 1) route.cell.push_back(s.cell);
    std::reverse(route.cell.begin(), route.cell.end());
    return route;
  }

  const RouteCells& cells_;
  const RouteCosts& costs_;
  const Turning& turning_;
  const std::vector<std::uint32_t>& stops_;
  std::vector<LineStep> steps_;                // by direction
  std::vector<std::vector<float>> remaining_;  // [leg][cell] without turns, to the last stop
  std::vector<std::uint32_t> place_;           // [leg][cell] in found_
  std::vector<States> found_;
  std::vector<char> passable_;  // [cell] in some heading
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

std::optional<FoundRoute> search_turning(const RouteCells& cells, const RouteCosts& costs, const Turning& turning,
                                         const std::vector<std::uint32_t>& stops) {
  std::vector<std::uint32_t> stop = stops;
  stop.erase(std::unique(stop.begin(), stop.end()), stop.end());
  if (stop.size() < 2) return FoundRoute{0, stop};
  return TurningSearch(cells, costs, turning, stop).run();
}

}  // namespace gonogo::map
