#include "pipeline/map/route/search/turning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "base/error.h"
#include "base/progress.h"
#include "pipeline/map/route/search/any_angle.h"

namespace gonogo::map {

Turning::Turning(const RouteCells& cells, const RouteCosts& costs, double quarter)
    : cells_(cells), costs_(costs), quarter_(quarter) {
  GONOGO_ASSERT(std::isfinite(quarter) && quarter > 0);
  for (const LineStep& step : line_steps(cells, false)) direction_.push_back(step.heading);
  std::sort(direction_.begin(), direction_.end());
}

Turn Turning::clockwise(std::uint32_t cell, int from, int to) const {
  const int angle = (to - from + 360) % 360;
  Turn turn{0, double(angle)};
  int done = 0;
  for (auto next = std::upper_bound(direction_.begin(), direction_.end(), from); done < angle; ++next) {
    if (next == direction_.end()) next = direction_.begin();
    const int ahead = (*next - from + 359) % 360 + 1;
    const int reached = ahead > done ? std::min(angle, ahead) : angle;  // none lies between the last one and `to`
    turn.cost += piece(cell, (from + done) % 360, (from + reached) % 360, reached - done);
    done = reached;
  }
  return turn;
}

Turn Turning::turn(std::uint32_t cell, int from, int to) const {
  if (from == to) return {};
  const Turn right = clockwise(cell, from, to);
  Turn left = clockwise(cell, to, from);
  return left.cost < right.cost || (left.cost == right.cost && left.degrees < right.degrees) ? left : right;
}

Turn Turning::turns(const std::vector<std::uint32_t>& corner) const {
  Turn sum;
  for (std::size_t i = 1; i + 1 < corner.size(); ++i) {
    const LineOfCells before(cells_, corner[i - 1], corner[i]), after(cells_, corner[i], corner[i + 1]);
    const Turn one = turn(corner[i], before.heading, after.heading);
    sum.cost += one.cost;
    sum.degrees += one.degrees;
  }
  return sum;
}

double cost_with_turns(const RouteCells& cells, const RouteCosts& costs, const Turning& turning,
                       const std::vector<std::uint32_t>& corner) {
  double sum = turning.turns(corner).cost;
  for (std::size_t i = 1; i < corner.size(); ++i) sum += line_cost(cells, costs, corner[i - 1], corner[i]);
  return sum;
}

namespace {

constexpr std::size_t kTurningWindow = 40;  // corners that one line may replace
constexpr int kTurningSweeps = 60;          // most rounds
constexpr double kLeast = 1e-9;             // share that a change must save

/// Makes a way cheaper by leaving out and moving corners that are no stops.
class Straightener {
 public:
  Straightener(const RouteCells& cells, const RouteCosts& costs, const Turning& turning,
               const std::vector<std::uint32_t>& way, const std::vector<std::uint32_t>& stops)
      : cells_(cells), costs_(costs), turning_(turning), way_(way), line_(way.size()), turn_(way.size()) {
    std::size_t next = 0;
    for (const std::uint32_t cell : way) {
      const std::size_t first = next;
      while (next < stops.size() && stops[next] == cell) ++next;
      fixed_.push_back(next > first);
    }
    for (std::size_t i = 0; i < way.size(); ++i) {
      if (i + 1 < way.size()) line_[i] = line_cost(cells, costs, way[i], way[i + 1]);
      turn_[i] = turn_at(i);
    }
  }

  std::vector<std::uint32_t> run() {
    for (int sweep = 0; sweep < kTurningSweeps; ++sweep) {
      const bool shorter = leave_out(), moved = move();
      if (!shorter && !moved) break;
    }
    return way_;
  }

 private:
  double turn(std::uint32_t from, std::uint32_t at, std::uint32_t to) const {
    return turning_.turn(at, LineOfCells(cells_, from, at).heading, LineOfCells(cells_, at, to).heading).cost;
  }
  double turn_at(std::size_t i) const {
    return i > 0 && i + 1 < way_.size() ? turn(way_[i - 1], way_[i], way_[i + 1]) : 0;
  }

  /// Cost of the line from corner i to corner j in place of what is between, with the turns at both.
  double straight(std::size_t i, std::size_t j) const {
    double sum = line_cost(cells_, costs_, way_[i], way_[j]);
    if (std::isfinite(sum) && i > 0) sum += turn(way_[i - 1], way_[i], way_[j]);
    if (std::isfinite(sum) && j + 1 < way_.size()) sum += turn(way_[i], way_[j], way_[j + 1]);
    return sum;
  }

  void erase(std::size_t from, std::size_t to) {
    const auto in = [&](auto& list) {
      list.erase(list.begin() + std::ptrdiff_t(from), list.begin() + std::ptrdiff_t(to));
    };
    in(way_);
    in(fixed_);
    in(line_);
    in(turn_);
    line_[from - 1] = line_cost(cells_, costs_, way_[from - 1], way_[from]);
    turn_[from - 1] = turn_at(from - 1);
    turn_[from] = turn_at(from);
  }

  bool leave_out() {
    bool changed = false;
    for (std::size_t i = 0; i + 2 < way_.size(); ++i) {
      std::size_t best = i + 1;
      double most = 0, now = turn_[i] + line_[i];
      for (std::size_t j = i + 2; j < way_.size() && j <= i + kTurningWindow && !fixed_[j - 1]; ++j) {
        now += turn_[j - 1] + line_[j - 1];
        if (way_[i] == way_[j]) continue;
        const double saved = now + turn_[j] - straight(i, j);
        if (saved <= most + kLeast * now) continue;
        most = saved;
        best = j;
      }
      if (best == i + 1) continue;
      erase(i + 1, best);
      changed = true;
    }
    return changed;
  }

  /// Cost of the two lines at corner i and the turns at their ends if it were `cell`.
  double over(std::size_t i, std::uint32_t cell) const {
    double sum = line_cost(cells_, costs_, way_[i - 1], cell) + line_cost(cells_, costs_, cell, way_[i + 1]);
    if (std::isfinite(sum)) sum += turn(way_[i - 1], cell, way_[i + 1]);
    if (std::isfinite(sum) && i > 1) sum += turn(way_[i - 2], way_[i - 1], cell);
    if (std::isfinite(sum) && i + 2 < way_.size()) sum += turn(cell, way_[i + 1], way_[i + 2]);
    return sum;
  }

  bool move() {
    bool changed = false;
    for (std::size_t i = 1; i + 1 < way_.size(); ++i) {
      if (fixed_[i]) continue;
      double least = turn_[i - 1] + line_[i - 1] + turn_[i] + line_[i] + turn_[i + 1];
      const std::uint32_t old = way_[i];
      const int columns = cells_.columns, column = int(old) % columns, row = int(old) / columns;
      for (int y = std::max(0, row - 1); y <= std::min(cells_.rows - 1, row + 1); ++y)
        for (int x = std::max(0, column - 1); x <= std::min(columns - 1, column + 1); ++x) {
          const auto cell = std::uint32_t(y) * std::uint32_t(columns) + std::uint32_t(x);
          if (cell == way_[i - 1] || cell == old || cell == way_[i + 1]) continue;
          const double sum = over(i, cell);
          if (!(sum < least * (1 - kLeast))) continue;
          least = sum;
          way_[i] = cell;
        }
      if (way_[i] == old) continue;
      changed = true;
      for (const std::size_t k : {i - 1, i}) line_[k] = line_cost(cells_, costs_, way_[k], way_[k + 1]);
      for (const std::size_t k : {i - 1, i, i + 1}) turn_[k] = turn_at(k);
    }
    return changed;
  }

  const RouteCells& cells_;
  const RouteCosts& costs_;
  const Turning& turning_;
  std::vector<std::uint32_t> way_;
  std::vector<double> line_, turn_;  // [corner] the line to the next one, and the turn
  std::vector<char> fixed_;
};

}  // namespace

std::optional<FoundRoute> find_turning(const RouteCells& cells, const RouteCosts& costs, const Turning& turning,
                                       const std::vector<std::uint32_t>& stops) {
  const auto found = search_turning(cells, costs, turning, stops);
  if (!found) return std::nullopt;
  std::vector<std::uint32_t> plain = {stops.front()};  // the way without turns, which is straight already
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const auto leg = find_any_angle(cells, costs, stops[i - 1], stops[i]);
    GONOGO_ASSERT(leg);
    plain.insert(plain.end(), leg->cell.begin() + 1, leg->cell.end());
  }
  FoundRoute best{std::numeric_limits<double>::infinity(), {}};
  for (const auto& way : {found->cell, plain}) {
    FoundRoute route{0, Straightener(cells, costs, turning, way, stops).run()};
    route.cost = cost_with_turns(cells, costs, turning, route.cell);
    if (route.cost < best.cost) best = route;
  }
  return best;
}

namespace {

constexpr int kDirections = 32;

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
      : cells_(cells),
        costs_(costs),
        turning_(turning),
        stops_(stops),
        steps_(line_steps(cells, false)),
        packed_(cells, costs) {
    std::sort(steps_.begin(), steps_.end(), [](auto& a, auto& b) { return a.heading < b.heading; });
    for (std::size_t leg = 0; leg < legs(); ++leg)
      remaining_.push_back(reach_any_angle(cells, costs, stops[leg + 1], true));
    for (std::size_t leg = legs() - 1; leg-- > 0;) {  // and all later legs
      const float later = remaining_[leg + 1][stops[leg + 1]];
      for (float& r : remaining_[leg]) r += later;
    }
    place_.assign(legs() * cells.soil.size(), kNone);
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
  /// Among equal sums the smaller number comes first.
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
      found_.emplace_back().cost.fill(RouteCosts::kImpassable);
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
    if (!packed_.passable(beside(step.offset))) return;
    for (int k = 0; k < step.corners; ++k)
      if (!packed_.passable(beside(step.corner[std::size_t(k)]))) return;
    offer({s.leg, std::uint32_t(beside(step.offset)), s.direction},
          step.add_cost(packed_, s.cell, cost, RouteCosts::kImpassable), kDriven);
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
  std::vector<LineStep> steps_;  // by direction
  PackedCells packed_;
  std::vector<std::vector<float>> remaining_;  // [leg][cell] without turns, to the last stop
  std::vector<std::uint32_t> place_;           // [leg][cell] in found_
  std::vector<States> found_;
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
