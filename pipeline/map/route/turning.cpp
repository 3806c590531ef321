#include "pipeline/map/route/turning.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "pipeline/map/route/any_angle.h"
#include "pipeline/map/route/line_step.h"

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

constexpr std::size_t kWindow = 40;  // corners that one line may replace
constexpr int kSweeps = 60;          // most rounds
constexpr double kLeast = 1e-9;      // share that a change must save

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
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
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

  /// Of the line from corner i to corner j in place of what is between, with the turns at both.
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
      for (std::size_t j = i + 2; j < way_.size() && j <= i + kWindow && !fixed_[j - 1]; ++j) {
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

  /// Of the two lines at corner i and the turns at their ends, were it `cell`.
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

}  // namespace gonogo::map
