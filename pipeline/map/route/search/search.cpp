// The cells of a map as a graph of the Boost Graph Library. Vertices are cells; edges are the steps to passable
// neighbours. Edges are computed on demand; one byte per cell says which of the eight steps are open.

#include "pipeline/map/route/search/search.h"
#include "base/parallel/host_loop.h"

#include <boost/graph/breadth_first_search.hpp>
#include <boost/graph/graph_traits.hpp>
#include <boost/graph/two_bit_color_map.hpp>
#include <boost/iterator/counting_iterator.hpp>
#include <boost/iterator/iterator_facade.hpp>
#include <cmath>
#include <utility>

#include "base/progress.h"

namespace gonogo::map {

class StepGraph {
 public:
  using Vertex = std::size_t;
  struct Edge {
    Vertex from = 0;
    int step = 0;
    float cost = 0;
    bool operator==(const Edge&) const = default;
  };

  StepGraph(const RouteCells& cells, const RouteCosts& costs, bool backwards)
      : cells_(&cells), costs_(&costs), steps_(route_steps(cells.cell_width, cells.cell_height)) {
    for (std::size_t s = 0; s < 8; ++s) {
      offset_[s] = std::ptrdiff_t(steps_[s].row) * cells.columns + steps_[s].column;
      half_length_[s] = float(steps_[s].length / 2);
      heading_[s] = backwards ? (steps_[s].heading + 180) % 360 : steps_[s].heading;
    }
    find_open_steps();
  }

  Vertex size() const { return cells_->soil.size(); }
  Vertex target(Vertex from, int step) const { return Vertex(std::ptrdiff_t(from) + offset_[std::size_t(step)]); }
  /// Bit s is set if step s stays on the map and ends in a cell that some heading passes. A diagonal step also needs
  /// that both cells beside it are such.
  unsigned open_steps(Vertex from) const { return open_[from]; }
  /// Gives the costs found so far [cell]; they must outlive the search. A step to a cell whose cost is not larger
  /// cannot shorten any way. Such steps, half of all, are left out from now on.
  void leave_out_steps_back(const std::vector<float>& cost) { known_ = cost.data(); }
  bool leads_back(Vertex from, int step) const { return known_ && known_[target(from, step)] <= known_[from]; }
  /// Cost of the step; infinity if one of its two cells cannot be passed in this heading. In a backwards graph: of the
  /// step from target to source.
  float cost(Vertex from, int step) const {
    const auto s = std::size_t(step);
    return half_length_[s] * (costs_->per_metre(*cells_, from, heading_[s]) +
                              costs_->per_metre(*cells_, target(from, step), heading_[s]));
  }

 private:
  void find_open_steps() {
    const int columns = cells_->columns, rows = cells_->rows;
    std::vector<char> passable(size());
    open_.resize(size());
    for_each_on_host(passable.size(), kCellsAtOnce,
                     [&](std::size_t c) { passable[c] = costs_->ever_passable(*cells_, c); });
    for_each_on_host(std::size_t(rows), 16, [&](std::size_t y_here) {
      const int row = int(y_here);
      for (int column = 0; column < columns; ++column) {
        const auto is_open = [&](int x, int y) {
          return x >= 0 && y >= 0 && x < columns && y < rows &&
                 passable[std::size_t(y) * std::size_t(columns) + std::size_t(x)] != 0;
        };
        unsigned open = 0;
        for (unsigned s = 0; s < 8; ++s) {
          const int x = column + steps_[s].column, y = row + steps_[s].row;
          if (is_open(x, y) && (s % 2 == 0 || (is_open(x, row) && is_open(column, y)))) open |= 1u << s;
        }
        open_[y_here * std::size_t(columns) + std::size_t(column)] = std::uint8_t(open);
      }
    });
  }

  const RouteCells* cells_;
  const RouteCosts* costs_;
  const float* known_ = nullptr;
  std::array<RouteStep, 8> steps_;
  std::array<std::ptrdiff_t, 8> offset_{};
  std::array<float, 8> half_length_{};
  std::array<int, 8> heading_{};
  std::vector<std::uint8_t> open_;
};

/// Iterates over the steps from a cell that have a finite cost.
class StepIterator
    : public boost::iterator_facade<StepIterator, StepGraph::Edge, boost::forward_traversal_tag, StepGraph::Edge> {
 public:
  StepIterator() = default;
  StepIterator(const StepGraph* graph, StepGraph::Vertex from, unsigned left)
      : graph_(graph), edge_{from}, left_(left) {
    find_next();
  }

 private:
  friend class boost::iterator_core_access;
  void find_next() {
    for (; left_ != 0; left_ &= left_ - 1) {
      const int step = std::countr_zero(left_);
      if (graph_->leads_back(edge_.from, step)) continue;
      const float cost = graph_->cost(edge_.from, step);
      if (!(cost < RouteCosts::kImpassable)) continue;
      edge_.step = step;
      edge_.cost = cost;
      return;
    }
  }
  void increment() {
    left_ &= left_ - 1;
    find_next();
  }
  bool equal(const StepIterator& other) const { return left_ == other.left_; }
  StepGraph::Edge dereference() const { return edge_; }

  const StepGraph* graph_ = nullptr;
  StepGraph::Edge edge_;
  unsigned left_ = 0;  // bit s: step s is not yet visited; the lowest bit is the current step
};

inline std::pair<StepIterator, StepIterator> out_edges(StepGraph::Vertex v, const StepGraph& g) {
  return {StepIterator(&g, v, g.open_steps(v)), StepIterator(&g, v, 0)};
}
inline std::size_t out_degree(StepGraph::Vertex, const StepGraph&) { return 8; }
inline StepGraph::Vertex source(const StepGraph::Edge& e, const StepGraph&) { return e.from; }
inline StepGraph::Vertex target(const StepGraph::Edge& e, const StepGraph& g) { return g.target(e.from, e.step); }
inline std::size_t num_vertices(const StepGraph& g) { return g.size(); }
inline std::pair<boost::counting_iterator<std::size_t>, boost::counting_iterator<std::size_t>> vertices(
    const StepGraph& g) {
  return {boost::counting_iterator<std::size_t>(0), boost::counting_iterator<std::size_t>(g.size())};
}

}  // namespace gonogo::map

template <>
struct boost::graph_traits<gonogo::map::StepGraph> {
  using vertex_descriptor = std::size_t;
  using edge_descriptor = gonogo::map::StepGraph::Edge;
  using out_edge_iterator = gonogo::map::StepIterator;
  using vertex_iterator = boost::counting_iterator<std::size_t>;
  using directed_category = boost::directed_tag;
  using edge_parallel_category = boost::disallow_parallel_edge_tag;
  struct traversal_category : boost::incidence_graph_tag, boost::vertex_list_graph_tag {};
  using vertices_size_type = std::size_t;
  using degree_size_type = std::size_t;
  using edges_size_type = std::size_t;
  static std::size_t null_vertex() { return std::size_t(-1); }
};

namespace gonogo::map {

namespace {

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
