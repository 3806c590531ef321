#include "sim/local_problem/tensor_train/hierarchy.h"

#include <algorithm>

namespace gonogo::sim {
namespace {

using Eigen::Index;

using Graph = std::vector<std::vector<Index>>;

Graph block_graph(const Eigen::SparseMatrix<double>& a, int block) {
  Graph graph(std::size_t(a.cols() / block));
  for (Index k = 0; k < a.outerSize(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(a, k); it; ++it)
      if (it.row() / block != it.col() / block) graph[std::size_t(it.col() / block)].push_back(it.row() / block);
  for (auto& near : graph) {
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
  }
  return graph;
}

class Halving {
 public:
  Halving(const Graph& graph, Hierarchy& out, int block)
      : graph_(graph), out_(out), block_(block), part_(graph.size(), -1), seen_(graph.size(), 0) {}

  void split(std::vector<Index> nodes, int level, Index first_place) {
    if (level == out_.levels) {
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (int a = 0; a < block_; ++a)
          out_.place[std::size_t(nodes[k] * block_ + a)] = first_place + Index(k) * block_ + a;
      return;
    }
    ++mark_;
    for (const Index node : nodes) part_[std::size_t(node)] = mark_;
    nodes = breadth_first(breadth_first(nodes).back(), nodes);
    const auto middle = nodes.begin() + std::ptrdiff_t((nodes.size() + 1) / 2);
    const Index half = out_.leaf_rows << (out_.levels - level - 1);
    const std::vector<Index> first(nodes.begin(), middle), second(middle, nodes.end());
    split(first, level + 1, first_place);
    split(second, level + 1, first_place + half);
  }

 private:
  std::vector<Index> breadth_first(const std::vector<Index>& nodes) {
    return nodes.empty() ? std::vector<Index>{0} : breadth_first(nodes.front(), nodes);
  }

  /// All `nodes` of the part, component by component, from `start`.
  std::vector<Index> breadth_first(Index start, const std::vector<Index>& nodes) {
    std::vector<Index> order;
    if (nodes.empty()) return order;
    ++visit_;
    const auto take = [&](Index node) {
      if (part_[std::size_t(node)] != mark_ || seen_[std::size_t(node)] == visit_) return;
      seen_[std::size_t(node)] = visit_;
      order.push_back(node);
    };
    take(start);
    std::size_t next = 0;
    for (std::size_t k = 0; k <= nodes.size(); ++k) {
      for (; next < order.size(); ++next)
        for (const Index near : graph_[std::size_t(order[next])]) take(near);
      if (k < nodes.size()) take(nodes[k]);
    }
    return order;
  }

  const Graph& graph_;
  Hierarchy& out_;
  int block_;
  std::vector<long> part_, seen_;
  long mark_ = 0, visit_ = 0;
};

}  // namespace

Hierarchy make_hierarchy(const Eigen::SparseMatrix<double>& pattern, int block, int leaf_nodes) {
  const Graph graph = block_graph(pattern, block);
  const Index count = Index(graph.size());
  Hierarchy out;
  out.levels = 1;
  while (((count - 1) >> out.levels) + 1 > leaf_nodes) ++out.levels;
  out.leaf_rows = (((count - 1) >> out.levels) + 1) * block;
  out.place.resize(std::size_t(pattern.rows()));
  std::vector<Index> nodes(graph.size());
  for (Index k = 0; k < count; ++k) nodes[std::size_t(k)] = k;
  Halving(graph, out, block).split(std::move(nodes), 0, 0);
  return out;
}

}  // namespace gonogo::sim
