#include "sim/local_problem/banded/reorder.h"

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/cuthill_mckee_ordering.hpp>
#include <utility>

namespace gonogo::sim {

using Eigen::Index;
using Sparse = Eigen::SparseMatrix<double>;

std::vector<Index> reverse_cuthill_mckee(const Sparse& a) {
  using Graph = boost::adjacency_list<
      boost::vecS, boost::vecS, boost::undirectedS,
      boost::property<boost::vertex_color_t, boost::default_color_type, boost::property<boost::vertex_degree_t, int>>>;
  std::vector<std::pair<Index, Index>> edges;  // each once, from low to high
  for (Index k = 0; k < a.outerSize(); ++k)
    for (Sparse::InnerIterator it(a, k); it; ++it)
      if (it.row() != it.col()) edges.emplace_back(std::minmax(it.row(), it.col()));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Graph graph(edges.begin(), edges.end(), std::size_t(a.rows()));
  std::vector<std::size_t> order(std::size_t(a.rows()));
  boost::cuthill_mckee_ordering(graph, order.rbegin(), get(boost::vertex_color, graph), boost::make_degree_map(graph));
  return {order.begin(), order.end()};
}

Band to_band(const Sparse& a, const std::vector<Index>& order, Index most_half) {
  std::vector<Index> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[std::size_t(order[k])] = Index(k);
  const auto visit = [&](auto&& use) {
    for (Index k = 0; k < a.outerSize(); ++k)
      for (Sparse::InnerIterator it(a, k); it; ++it)
        use(place[std::size_t(it.row())], place[std::size_t(it.col())], it.value());
  };
  Band band;
  visit([&](Index i, Index j, double) { band.full_half = std::max(band.full_half, std::abs(i - j)); });
  band.matrix = BandedMatrix<double>(a.rows(), std::min(band.full_half, most_half));
  double all = 0, outside = 0;
  visit([&](Index i, Index j, double value) {
    all += value * value;
    if (std::abs(i - j) <= band.matrix.half)
      band.matrix.at(i, j) += value;
    else
      outside += value * value;
  });
  band.dropped = all > 0 ? std::sqrt(outside / all) : 0;
  return band;
}

}  // namespace gonogo::sim
