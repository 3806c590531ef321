// The cells of a map as a graph of the Boost Graph Library: vertices are cells, edges the steps to the neighbours that
// can be passed. Nothing is stored but the cells.
#pragma once
#include <boost/graph/graph_traits.hpp>
#include <boost/iterator/counting_iterator.hpp>
#include <boost/iterator/iterator_facade.hpp>
#include <boost/property_map/property_map.hpp>
#include <utility>

#include "pipeline/route/cost.h"

namespace gonogo::pipeline {

class StepGraph {
 public:
  using Vertex = std::size_t;
  struct Edge {
    Vertex from = 0;
    int step = 0;
    bool operator==(const Edge&) const = default;
  };

  StepGraph(const RouteCells& cells, const RouteCosts& costs, bool backwards)
      : cells_(&cells),
        costs_(&costs),
        steps_(route_steps(cells.cell_width, cells.cell_height)),
        backwards_(backwards) {
    passable_.resize(cells.soil.size());
    for (std::size_t c = 0; c < passable_.size(); ++c) passable_[c] = costs.ever_passable(cells, c);
  }

  Vertex size() const { return cells_->soil.size(); }
  Vertex target(const Edge& e) const {
    const RouteStep& step = steps_[std::size_t(e.step)];
    return Vertex(std::ptrdiff_t(e.from) + std::ptrdiff_t(step.row) * cells_->columns + step.column);
  }
  /// Whether the step stays on the map, ends in a cell that some heading passes, and, if diagonal, touches no cell that
  /// none does.
  bool exists(const Edge& e) const {
    const RouteStep& step = steps_[std::size_t(e.step)];
    const auto from = std::uint32_t(e.from), width = std::uint32_t(cells_->columns);  // divides faster than 64 bits
    const int row = int(from / width), column = int(from - std::uint32_t(row) * width);
    const int x = column + step.column, y = row + step.row;
    if (x < 0 || y < 0 || x >= cells_->columns || y >= cells_->rows) return false;
    const auto open = [&](int c, int r) { return passable_[std::size_t(r) * std::size_t(cells_->columns) + c] != 0; };
    return open(x, y) && (e.step % 2 == 0 || (open(x, row) && open(column, y))) && !leads_back(e.from, target(e));
  }
  /// Costs found so far: steps to cells that are no farther than the one they start from cannot shorten any way, and
  /// are left out from now on. Half of all steps are such.
  void leave_out_steps_back(const std::vector<float>& cost) { known_ = cost.data(); }
  /// Infinity where one of the two cells cannot be passed in this heading. Backwards: of the step from target to
  /// source.
  float cost(const Edge& e) const {
    const RouteStep& step = steps_[std::size_t(e.step)];
    const int heading = backwards_ ? (step.heading + 180) % 360 : step.heading;
    return float(step.length / 2) *
           (costs_->per_metre(*cells_, e.from, heading) + costs_->per_metre(*cells_, target(e), heading));
  }

 private:
  bool leads_back(Vertex from, Vertex to) const { return known_ && known_[to] <= known_[from]; }

  const RouteCells* cells_;
  const RouteCosts* costs_;
  const float* known_ = nullptr;
  std::array<RouteStep, 8> steps_;
  std::vector<char> passable_;
  bool backwards_;
};

class StepIterator
    : public boost::iterator_facade<StepIterator, StepGraph::Edge, boost::forward_traversal_tag, StepGraph::Edge> {
 public:
  StepIterator() = default;
  StepIterator(const StepGraph* graph, StepGraph::Edge edge) : graph_(graph), edge_(edge) { skip(); }

 private:
  friend class boost::iterator_core_access;
  void skip() {
    while (edge_.step < 8 && !graph_->exists(edge_)) ++edge_.step;
  }
  void increment() {
    ++edge_.step;
    skip();
  }
  bool equal(const StepIterator& other) const { return edge_ == other.edge_; }
  StepGraph::Edge dereference() const { return edge_; }

  const StepGraph* graph_ = nullptr;
  StepGraph::Edge edge_;
};

inline std::pair<StepIterator, StepIterator> out_edges(StepGraph::Vertex v, const StepGraph& g) {
  return {StepIterator(&g, {v, 0}), StepIterator(&g, {v, 8})};
}
inline std::size_t out_degree(StepGraph::Vertex, const StepGraph&) { return 8; }
inline StepGraph::Vertex source(const StepGraph::Edge& e, const StepGraph&) { return e.from; }
inline StepGraph::Vertex target(const StepGraph::Edge& e, const StepGraph& g) { return g.target(e); }
inline std::size_t num_vertices(const StepGraph& g) { return g.size(); }
inline std::pair<boost::counting_iterator<std::size_t>, boost::counting_iterator<std::size_t>> vertices(
    const StepGraph& g) {
  return {boost::counting_iterator<std::size_t>(0), boost::counting_iterator<std::size_t>(g.size())};
}

struct StepCost {
  using key_type = StepGraph::Edge;
  using value_type = float;
  using reference = float;
  using category = boost::readable_property_map_tag;
  const StepGraph* graph;
};
inline float get(const StepCost& map, const StepGraph::Edge& e) { return map.graph->cost(e); }

}  // namespace gonogo::pipeline

template <>
struct boost::graph_traits<gonogo::pipeline::StepGraph> {
  using vertex_descriptor = std::size_t;
  using edge_descriptor = gonogo::pipeline::StepGraph::Edge;
  using out_edge_iterator = gonogo::pipeline::StepIterator;
  using vertex_iterator = boost::counting_iterator<std::size_t>;
  using directed_category = boost::directed_tag;
  using edge_parallel_category = boost::disallow_parallel_edge_tag;
  struct traversal_category : boost::incidence_graph_tag, boost::vertex_list_graph_tag {};
  using vertices_size_type = std::size_t;
  using degree_size_type = std::size_t;
  using edges_size_type = std::size_t;
  static std::size_t null_vertex() { return std::size_t(-1); }
};
