#include "sim/local_problem/block_pattern.h"

#include <Eigen/OrderingMethods>
#include <algorithm>

namespace gonogo::sim {
namespace {

using Eigen::Index;
using Lists = std::vector<std::vector<Index>>;

/// Columns of each row left of the diagonal, rows and columns in `order`.
Lists lower_rows(const Eigen::SparseMatrix<double>& a, const std::vector<Index>& order) {
  std::vector<Index> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[std::size_t(order[k])] = Index(k);
  Lists rows(order.size());
  for (Index k = 0; k < a.outerSize(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(a, k); it; ++it) {
      const Index i = place[std::size_t(it.row())], j = place[std::size_t(it.col())];
      if (j < i) rows[std::size_t(i)].push_back(j);
    }
  return rows;
}

/// Parent of each column in the elimination tree (Liu 1990); -1 for roots.
std::vector<Index> elimination_tree(const Lists& rows) {
  std::vector<Index> parent(rows.size(), -1), ancestor(rows.size(), -1);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (Index j : rows[i])
      while (j != -1 && j != Index(i)) {
        const Index next = ancestor[std::size_t(j)];
        ancestor[std::size_t(j)] = Index(i);
        if (next == -1) parent[std::size_t(j)] = Index(i);
        j = next;
      }
  return parent;
}

/// Columns in an order in which every subtree is contiguous, children before parents.
std::vector<Index> postorder(const std::vector<Index>& parent) {
  Lists child(parent.size());
  std::vector<Index> open, order;
  for (std::size_t k = parent.size(); k-- > 0;) {
    if (parent[k] >= 0)
      child[std::size_t(parent[k])].push_back(Index(k));
    else
      open.push_back(Index(k));
  }
  // Parents before children, last child first, turned around.
  std::reverse(open.begin(), open.end());
  while (!open.empty()) {
    const Index k = open.back();
    open.pop_back();
    order.push_back(k);
    const auto& below = child[std::size_t(k)];
    open.insert(open.end(), below.begin(), below.end());
  }
  std::reverse(order.begin(), order.end());
  return order;
}

/// Rows of each column of L below the diagonal, ascending.
Lists factor_columns(const Lists& rows, const std::vector<Index>& parent) {
  const std::size_t n = rows.size();
  Lists column(n);
  for (std::size_t i = 0; i < n; ++i)
    for (const Index j : rows[i]) column[std::size_t(j)].push_back(Index(i));
  std::vector<std::vector<Index>> child(n);
  for (std::size_t k = 0; k < n; ++k)
    if (parent[k] >= 0) child[std::size_t(parent[k])].push_back(Index(k));
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<Index>& own = column[j];
    for (const Index c : child[j])
      for (const Index i : column[std::size_t(c)])
        if (i != Index(j)) own.push_back(i);
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  }
  return column;
}

/// Blocks of a group's columns on and below the diagonal.
Index entries(const ColumnGroup& g) { return g.width * (g.width + 1) / 2 + g.width * Index(g.row.size()); }

/// Whether `below`, whose parent is `g` and which ends where g begins, is worth merging into it; then merges.
bool merge(const ColumnGroup& below, ColumnGroup& g) {
  constexpr Index kSmall = 4;  // columns: a front costs as much as some zeros
  constexpr double kZeros = 0.1;
  if (below.row.empty() || below.first + below.width != g.first || below.row[0] >= g.first + g.width) return false;
  const Index added = below.width * (g.width + Index(g.row.size()) - Index(below.row.size()));
  ColumnGroup both{below.first, below.width + g.width, g.row, below.filled + g.filled + added};
  if (both.width > kSmall && double(both.filled) > kZeros * double(entries(both))) return false;
  if (both.width <= kSmall && 2 * both.filled > entries(both)) return false;
  g = both;
  return true;
}

std::vector<ColumnGroup> groups_of(const Lists& column, const std::vector<Index>& parent) {
  std::vector<ColumnGroup> alike;
  for (std::size_t j = 0; j < column.size(); ++j) {
    const bool continues =
        j > 0 && parent[j - 1] == Index(j) && column[j - 1].size() == column[j].size() + 1 && !alike.empty();
    if (!continues) alike.push_back({.first = Index(j)});
    ++alike.back().width;
    alike.back().row = column[j];
  }
  std::vector<ColumnGroup> merged;
  for (ColumnGroup& g : alike) {
    while (!merged.empty() && merge(merged.back(), g)) merged.pop_back();
    merged.push_back(g);
  }
  return merged;
}

}  // namespace

FactorPattern factor_pattern(const Eigen::SparseMatrix<double>& a) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> by_degree;
  Eigen::AMDOrdering<int>()(a, by_degree);
  std::vector<Index> degree(std::size_t(a.rows()));
  for (Index k = 0; k < a.rows(); ++k) degree[std::size_t(k)] = by_degree.indices()[k];
  FactorPattern pattern;
  for (const Index k : postorder(elimination_tree(lower_rows(a, degree))))
    pattern.order.push_back(degree[std::size_t(k)]);
  const Lists rows = lower_rows(a, pattern.order);
  const std::vector<Index> parent = elimination_tree(rows);
  pattern.group = groups_of(factor_columns(rows, parent), parent);
  return pattern;
}

}  // namespace gonogo::sim
