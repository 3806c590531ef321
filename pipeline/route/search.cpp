#include "pipeline/route/search.h"

#include <algorithm>
#include <boost/graph/dijkstra_shortest_paths_no_color_map.hpp>

#include "base/cancel.h"
#include "pipeline/route/grid_graph.h"

namespace gonogo::pipeline {
namespace {

constexpr std::size_t kAnywhere = std::size_t(-1);

struct EndReached {};

class StopAt : public boost::dijkstra_visitor<> {
 public:
  explicit StopAt(std::size_t end) : end_(end) {}
  void examine_vertex(std::size_t cell, const StepGraph&) const {
    if (cell == end_) throw EndReached();
    if ((cell & 0xffff) == 0) stop_if_cancelled();
  }

 private:
  std::size_t end_;
};

struct Tree {
  std::vector<float> cost;
  std::vector<std::uint32_t> before;
};

Tree search(StepGraph graph, std::size_t start, std::size_t end) {
  Tree tree{std::vector<float>(graph.size(), std::numeric_limits<float>::infinity()),
            std::vector<std::uint32_t>(graph.size())};
  for (std::size_t c = 0; c < graph.size(); ++c) tree.before[c] = std::uint32_t(c);
  tree.cost[start] = 0;
  graph.leave_out_steps_back(tree.cost);
  const auto index = boost::typed_identity_property_map<std::size_t>();
  try {
    boost::dijkstra_shortest_paths_no_color_map_no_init(
        graph, start, boost::make_iterator_property_map(tree.before.begin(), index),
        boost::make_iterator_property_map(tree.cost.begin(), index), StepCost{&graph}, index, std::less<float>(),
        boost::closed_plus<float>(std::numeric_limits<float>::infinity()), std::numeric_limits<float>::infinity(), 0.0f,
        StopAt(end));
  } catch (const EndReached&) {
  }
  return tree;
}

}  // namespace

std::optional<FoundRoute> find_route(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                     std::uint32_t end) {
  const Tree tree = search(StepGraph(cells, costs, false), start, end);
  if (!std::isfinite(tree.cost[end])) return std::nullopt;
  FoundRoute route;
  route.cost = double(tree.cost[end]);
  for (std::uint32_t cell = end;; cell = tree.before[cell]) {
    route.cell.push_back(cell);
    if (cell == start) break;
  }
  std::reverse(route.cell.begin(), route.cell.end());
  return route;
}

std::vector<float> reach(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start, bool backwards) {
  return search(StepGraph(cells, costs, backwards), start, kAnywhere).cost;
}

std::vector<std::int32_t> connected_regions(const RouteCells& cells, const RouteCosts& costs) {
  const StepGraph there(cells, costs, false), back(cells, costs, true);
  std::vector<std::int32_t> region(there.size(), -1);
  std::int32_t count = 0;
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < region.size(); ++first) {
    if (region[first] >= 0 || !costs.ever_passable(cells, first)) continue;
    region[first] = count;
    open.push_back(first);
    while (!open.empty()) {
      const std::size_t cell = open.back();
      open.pop_back();
      for (auto [edge, end] = out_edges(cell, there); edge != end; ++edge) {
        const std::size_t next = there.target(*edge);
        if (region[next] >= 0 || !std::isfinite(there.cost(*edge)) || !std::isfinite(back.cost(*edge))) continue;
        region[next] = count;
        open.push_back(next);
      }
    }
    ++count;
  }
  return region;
}

}  // namespace gonogo::pipeline
