#include "pipeline/map/route/search.h"

#include <algorithm>
#include <boost/graph/breadth_first_search.hpp>
#include <boost/graph/two_bit_color_map.hpp>
#include <cmath>

#include "base/cancel.h"
#include "pipeline/map/route/grid_graph.h"
#include "pipeline/map/route/nearest_first.h"

namespace gonogo::map {
namespace {

constexpr std::size_t kAnywhere = std::size_t(-1);

struct EndReached {};

struct Tree {
  std::vector<float> cost;
  std::vector<std::uint32_t> before;
};

/// Dijkstra's search as what happens to the steps of a breadth-first search whose next cell is the nearest one.
class Nearest : public boost::default_bfs_visitor {
 public:
  Nearest(Tree& tree, NearestFirst& queue, std::size_t end) : tree_(&tree), queue_(&queue), end_(end) {}

  void examine_vertex(std::size_t cell, const StepGraph&) const {
    if (cell == end_) throw EndReached();
    if ((cell & 0xffff) == 0) stop_if_cancelled();
  }
  void tree_edge(const StepGraph::Edge& step, const StepGraph& graph) const {
    const std::size_t to = target(step, graph);
    tree_->cost[to] = tree_->cost[step.from] + step.cost;
    tree_->before[to] = std::uint32_t(step.from);
  }
  void gray_target(const StepGraph::Edge& step, const StepGraph& graph) const {
    const std::size_t to = target(step, graph);
    if (!(tree_->cost[step.from] + step.cost < tree_->cost[to])) return;
    tree_edge(step, graph);
    queue_->update(to);
  }

 private:
  Tree* tree_;
  NearestFirst* queue_;
  std::size_t end_;
};

Tree search(StepGraph graph, std::size_t start, std::size_t end) {
  Tree tree{std::vector<float>(graph.size(), std::numeric_limits<float>::infinity()),
            std::vector<std::uint32_t>(graph.size())};
  for (std::size_t c = 0; c < graph.size(); ++c) tree.before[c] = std::uint32_t(c);
  tree.cost[start] = 0;
  graph.leave_out_steps_back(tree.cost);
  NearestFirst queue(tree.cost);
  const boost::two_bit_color_map<> colours(graph.size());
  try {
    boost::breadth_first_visit(graph, start, queue, Nearest(tree, queue, end), colours);
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
        const auto [from, step, cost] = *edge;  // finite
        const std::size_t next = there.target(from, step);
        if (region[next] >= 0 || !std::isfinite(back.cost(from, step))) continue;
        region[next] = count;
        open.push_back(next);
      }
    }
    ++count;
  }
  return region;
}

}  // namespace gonogo::map
