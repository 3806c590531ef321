#include "sim/local_problem/algebra/block_ldlt.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>

#include "sim/local_problem/banded/band_factors.h"

namespace gonogo::sim {
namespace {

using Lists = std::vector<std::vector<Eigen::Index>>;

/// Columns of each row left of the diagonal, rows and columns in `order`.
Lists lower_rows(const Eigen::SparseMatrix<double>& a, const std::vector<Eigen::Index>& order) {
  std::vector<Eigen::Index> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[std::size_t(order[k])] = Eigen::Index(k);
  Lists rows(order.size());
  for (Eigen::Index k = 0; k < a.outerSize(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(a, k); it; ++it) {
      const Eigen::Index i = place[std::size_t(it.row())], j = place[std::size_t(it.col())];
      if (j < i) rows[std::size_t(i)].push_back(j);
    }
  return rows;
}

/// Parent of each column in the elimination tree (Liu 1990); -1 for roots.
std::vector<Eigen::Index> elimination_tree(const Lists& rows) {
  std::vector<Eigen::Index> parent(rows.size(), -1), ancestor(rows.size(), -1);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (Eigen::Index j : rows[i])
      while (j != -1 && j != Eigen::Index(i)) {
        const Eigen::Index next = ancestor[std::size_t(j)];
        ancestor[std::size_t(j)] = Eigen::Index(i);
        if (next == -1) parent[std::size_t(j)] = Eigen::Index(i);
        j = next;
      }
  return parent;
}

/// Columns in an order in which every subtree is contiguous, children before parents.
std::vector<Eigen::Index> postorder(const std::vector<Eigen::Index>& parent) {
  Lists child(parent.size());
  std::vector<Eigen::Index> open, order;
  for (std::size_t k = parent.size(); k-- > 0;) {
    if (parent[k] >= 0)
      child[std::size_t(parent[k])].push_back(Eigen::Index(k));
    else
      open.push_back(Eigen::Index(k));
  }
  // Parents before children, last child first, turned around.
  std::reverse(open.begin(), open.end());
  while (!open.empty()) {
    const Eigen::Index k = open.back();
    open.pop_back();
    order.push_back(k);
    const auto& below = child[std::size_t(k)];
    open.insert(open.end(), below.begin(), below.end());
  }
  std::reverse(order.begin(), order.end());
  return order;
}

/// Rows of each column of L below the diagonal, ascending.
Lists factor_columns(const Lists& rows, const std::vector<Eigen::Index>& parent) {
  const std::size_t n = rows.size();
  Lists column(n);
  for (std::size_t i = 0; i < n; ++i)
    for (const Eigen::Index j : rows[i]) column[std::size_t(j)].push_back(Eigen::Index(i));
  std::vector<std::vector<Eigen::Index>> child(n);
  for (std::size_t k = 0; k < n; ++k)
    if (parent[k] >= 0) child[std::size_t(parent[k])].push_back(Eigen::Index(k));
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<Eigen::Index>& own = column[j];
    for (const Eigen::Index c : child[j])
      for (const Eigen::Index i : column[std::size_t(c)])
        if (i != Eigen::Index(j)) own.push_back(i);
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  }
  return column;
}

/// Blocks of a group's columns on and below the diagonal.
Eigen::Index entries(const ColumnGroup& g) {
  return g.width * (g.width + 1) / 2 + g.width * Eigen::Index(g.row.size());
}

/// Whether `below`, whose parent is `g` and which ends where g begins, is worth merging into it; then merges.
bool merge(const ColumnGroup& below, ColumnGroup& g) {
  constexpr Eigen::Index kSmall = 4;  // columns: a front costs as much as some zeros
  constexpr double kZeros = 0.1;
  if (below.row.empty() || below.first + below.width != g.first || below.row[0] >= g.first + g.width) return false;
  const Eigen::Index added = below.width * (g.width + Eigen::Index(g.row.size()) - Eigen::Index(below.row.size()));
  ColumnGroup both{below.first, below.width + g.width, g.row, below.filled + g.filled + added};
  if (both.width > kSmall && double(both.filled) > kZeros * double(entries(both))) return false;
  if (both.width <= kSmall && 2 * both.filled > entries(both)) return false;
  g = both;
  return true;
}

std::vector<ColumnGroup> groups_of(const Lists& column, const std::vector<Eigen::Index>& parent) {
  std::vector<ColumnGroup> alike;
  for (std::size_t j = 0; j < column.size(); ++j) {
    const bool continues =
        j > 0 && parent[j - 1] == Eigen::Index(j) && column[j - 1].size() == column[j].size() + 1 && !alike.empty();
    if (!continues) alike.push_back({.first = Eigen::Index(j)});
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
  std::vector<Eigen::Index> degree(std::size_t(a.rows()));
  for (Eigen::Index k = 0; k < a.rows(); ++k) degree[std::size_t(k)] = by_degree.indices()[k];
  FactorPattern pattern;
  for (const Eigen::Index k : postorder(elimination_tree(lower_rows(a, degree))))
    pattern.order.push_back(degree[std::size_t(k)]);
  const Lists rows = lower_rows(a, pattern.order);
  const std::vector<Eigen::Index> parent = elimination_tree(rows);
  pattern.group = groups_of(factor_columns(rows, parent), parent);
  return pattern;
}

namespace {

using Lane = Lanes<double>;
using Columns = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

constexpr Eigen::Index kFrontPanel = 4;
/// Fronts beyond this go by blocks of columns, whose products Eigen multiplies.
constexpr Eigen::Index kSmall = 192, kBlock = 64;

class Front {
 public:
  Front(double* f, Eigen::Index rows, Eigen::Index step, double* inverse)
      : f_(f), rows_(rows), step_(step), inverse_(inverse) {}

  /// Columns [begin, end) eliminated from the columns before `last`. `begin`: a multiple of kFrontPanel.
  bool panels(Eigen::Index begin, Eigen::Index end, Eigen::Index last) {
    for (Eigen::Index p = begin; p < end; p += kFrontPanel) {
      const Eigen::Index count = std::min(kFrontPanel, end - p);
      const bool done = count == 4   ? panel<4>(p, last)
                        : count == 3 ? panel<3>(p, last)
                        : count == 2 ? panel<2>(p, last)
                                     : panel<1>(p, last);
      if (!done) return false;
    }
    return true;
  }

  /// The Schur complement behind `end`, of columns [begin, end).
  void take_block(Eigen::Index begin, Eigen::Index end) {
    const Eigen::Index count = end - begin;
    Eigen::MatrixXd scaled;
    for (Eigen::Index c = end; c < rows_; c += kBlock) {
      const Eigen::Index width = std::min(kBlock, rows_ - c);
      const Columns l(f_ + begin * step_ + c, rows_ - c, count, Eigen::OuterStride<>(step_));
      scaled.resize(count, width);
      for (Eigen::Index k = 0; k < count; ++k)
        for (Eigen::Index j = 0; j < width; ++j) scaled(k, j) = l(j, k) * f_[(begin + k) * step_ + begin + k];
      Columns(f_ + c * step_ + c, rows_ - c, width, Eigen::OuterStride<>(step_)).noalias() -= l * scaled;
    }
  }

 private:
  template <int Count>
  bool panel(Eigen::Index p, Eigen::Index last) {
    // L and D of the panel's square, which the columns below follow.
    double l[Count][Count], d[Count];
    for (int k = 0; k < Count; ++k) {
      for (int i = k; i < Count; ++i) {
        l[i][k] = f_[(p + k) * step_ + p + i];
        for (int j = 0; j < k; ++j) l[i][k] -= l[i][j] * l[k][j] * d[j];
      }
      d[k] = l[k][k];
      if (!(std::abs(d[k]) > 0) || !std::isfinite(d[k])) return false;
      inverse_[p + k] = 1 / d[k];
      for (int i = k + 1; i < Count; ++i) l[i][k] *= inverse_[p + k];
    }
    for (Eigen::Index i = p; i < step_; i += Lane::kWidth) {
      Lane::Pack u[Count];
      for (int k = 0; k < Count; ++k) {
        u[k] = Lane::load(f_ + (p + k) * step_ + i);
        for (int j = 0; j < k; ++j) u[k] = Lane::multiply_add(Lane::fill(-l[k][j]), u[j], u[k]);
        Lane::store(f_ + (p + k) * step_ + i, u[k] * Lane::fill(inverse_[p + k]));
      }
    }
    for (int k = 0; k < Count; ++k) f_[(p + k) * step_ + p + k] = d[k];
    take<Count>(p, p + Count, last);
    return true;
  }

  /// Columns [first, last) less the products of the done columns from p on.
  template <int Count>
  void take(Eigen::Index p, Eigen::Index first, Eigen::Index last) {
    Eigen::Index c = first;
    for (; c + 2 <= last; c += 2) take_from<Count, 2>(p, c);
    if (c < last) take_from<Count, 1>(p, c);
  }

  /// From Width columns at once, in whole packs from a row at or above the diagonal.
  template <int Count, int Width>
  void take_from(Eigen::Index p, Eigen::Index c) {
    Lane::Pack share[Width][Count];
    for (int k = 0; k < Count; ++k)
      for (int w = 0; w < Width; ++w)
        share[w][k] = Lane::fill(-f_[(p + k) * step_ + c + w] * f_[(p + k) * step_ + p + k]);
    for (Eigen::Index i = c / Lane::kWidth * Lane::kWidth; i < step_; i += Lane::kWidth) {
      Lane::Pack sum[Width];
      for (int w = 0; w < Width; ++w) sum[w] = Lane::load(f_ + (c + w) * step_ + i);
      for (int k = 0; k < Count; ++k) {
        const Lane::Pack l = Lane::load(f_ + (p + k) * step_ + i);
        for (int w = 0; w < Width; ++w) sum[w] = Lane::multiply_add(share[w][k], l, sum[w]);
      }
      for (int w = 0; w < Width; ++w) Lane::store(f_ + (c + w) * step_ + i, sum[w]);
    }
  }

  double* f_;
  Eigen::Index rows_, step_;
  double* inverse_;
};

}  // namespace

bool eliminate(double* f, Eigen::Index rows, Eigen::Index step, Eigen::Index count, double* inverse) {
  Front front(f, rows, step, inverse);
  if (rows <= kSmall) return front.panels(0, count, rows);
  for (Eigen::Index begin = 0; begin < count; begin += kBlock) {
    const Eigen::Index end = std::min(count, begin + kBlock);
    if (!front.panels(begin, end, end)) return false;
    front.take_block(begin, end);
  }
  return true;
}

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

/// Columns that sweeps take at once: a pack's width, so that the rows behind a group begin with a whole pack.
constexpr Eigen::Index kGroup = Lanes<double>::kWidth;

// Columns are short: a call of memset or memmove would cost more than the work.
void clear_packs(double* from, const double* to) {
  for (; from < to; from += Lane::kWidth) Lane::store(from, Lane::Pack{});
}
void copy_column(const double* from, Eigen::Index count, double* to) {
  Eigen::Index i = 0;
  for (; i + Lane::kWidth <= count; i += Lane::kWidth) Lane::store(to + i, Lane::load(from + i));
  for (; i < count; ++i) to[i] = from[i];
}

/// One entry per block of `size` rows.
Sparse block_graph(const Sparse& a, Eigen::Index size) {
  std::vector<Eigen::Triplet<double>> entry;
  for (Eigen::Index k = 0; k < a.outerSize(); ++k)
    for (Sparse::InnerIterator it(a, k); it; ++it) entry.emplace_back(it.row() / size, it.col() / size, 1);
  for (Eigen::Index k = 0; k < a.rows() / size; ++k) entry.emplace_back(k, k, 1);
  Sparse graph(a.rows() / size, a.rows() / size);
  graph.setFromTriplets(entry.begin(), entry.end());
  return graph;
}

}  // namespace

bool BlockLdlt::has_pattern_of(const Sparse& w) const {
  return begin_.size() == std::size_t(w.outerSize()) + 1 && inner_.size() == std::size_t(w.nonZeros()) &&
         std::equal(begin_.begin(), begin_.end(), w.outerIndexPtr()) &&
         std::equal(inner_.begin(), inner_.end(), w.innerIndexPtr());
}

void BlockLdlt::analyse(const Sparse& w) {
  begin_.assign(w.outerIndexPtr(), w.outerIndexPtr() + w.outerSize() + 1);
  inner_.assign(w.innerIndexPtr(), w.innerIndexPtr() + w.nonZeros());
  const FactorPattern pattern = factor_pattern(block_graph(w, size_));
  order_ = pattern.order;
  node_.clear();
  largest_step_ = 0;
  std::vector<Eigen::Index> node_of(order_.size()), place_of(order_.size());
  std::size_t values = 0;
  for (const ColumnGroup& g : pattern.group) {
    for (Eigen::Index k = 0; k < g.width; ++k) node_of[std::size_t(g.first + k)] = Eigen::Index(node_.size());
    node_.push_back({.first = g.first, .width = g.width, .row = g.row, .value = values});
    values += std::size_t(g.width * size_ * step(node_.back()));
  }
  value_.resize(values);
  inverse_.resize(std::size_t(w.rows()));
  for (std::size_t k = 0; k < order_.size(); ++k) place_of[std::size_t(order_[k])] = Eigen::Index(k);
  child_.assign(node_.size(), {});
  Eigen::Index largest = 0;
  for (std::size_t k = 0; k < node_.size(); ++k) {
    Supernode& s = node_[k];
    largest = std::max(largest, rows(s) * step(s));
    largest_step_ = std::max(largest_step_, std::size_t(step(s)));
    if (s.row.empty()) continue;
    s.parent = node_of[std::size_t(s.row[0])];
    child_[std::size_t(s.parent)].push_back(Eigen::Index(k));
    for (const Eigen::Index row : s.row) s.place.push_back(block_of(node_[std::size_t(s.parent)], row));
  }
  front_.resize(std::size_t(largest));
  place_entries(w, node_of, place_of);
}

void BlockLdlt::place_entries(const Sparse& w, const std::vector<Eigen::Index>& node_of,
                              const std::vector<Eigen::Index>& place_of) {
  for (Eigen::Index k = 0; k < w.outerSize(); ++k) {
    const Eigen::Index column = place_of[std::size_t(k / size_)];
    Supernode& s = node_[std::size_t(node_of[std::size_t(column)])];
    const Eigen::Index base = ((column - s.first) * size_ + k % size_) * step(s);
    Eigen::Index latest = -1, block = 0;
    for (Eigen::Index at = begin_[std::size_t(k)]; at < begin_[std::size_t(k) + 1]; ++at) {
      const Eigen::Index i = inner_[std::size_t(at)], row = place_of[std::size_t(i / size_)];
      if (row < column || (row == column && i < k)) continue;
      if (row != latest) block = block_of(s, row);
      latest = row;
      s.entry.push_back({int(at), int(base + block * size_ + i % size_)});
    }
  }
}

/// Place of a row among the blocks of a front.
Eigen::Index BlockLdlt::block_of(const Supernode& s, Eigen::Index row) {
  if (row < s.first + s.width) return row - s.first;
  return s.width + (std::lower_bound(s.row.begin(), s.row.end(), row) - s.row.begin());
}

void BlockLdlt::assemble(const Supernode& s, const Sparse& w, const Sparse& blocks) {
  for (Eigen::Index c = 0; c < rows(s); ++c)  // the lower triangle
    clear_packs(front_.data() + c * step(s) + c / kGroup * kGroup, front_.data() + (c + 1) * step(s));
  for (const Entry& e : s.entry) front_[std::size_t(e.to)] = w.valuePtr()[e.from];
  for (Eigen::Index b = 0; b < s.width; ++b)
    for (Eigen::Index c = 0; c < size_; ++c)
      for (Sparse::InnerIterator it(blocks, order_[std::size_t(s.first + b)] * size_ + c); it; ++it)
        if (it.row() >= it.col())
          front_[std::size_t((b * size_ + c) * step(s) + b * size_ + it.row() % size_)] += it.value();
}

/// What `child` left, added to the front of its parent s.
void BlockLdlt::add_left(const Supernode& child, const Supernode& s) {
  size_ == 3 ? add_blocks_left<3>(child, s, 3) : add_blocks_left<0>(child, s, size_);
}

/// Size: rows of a block where they are known when this is compiled, or 0.
template <int Size>
void BlockLdlt::add_blocks_left(const Supernode& child, const Supernode& s, Eigen::Index any_size) {
  const Eigen::Index size = Size > 0 ? Size : any_size, blocks = Eigen::Index(child.row.size()), height = blocks * size;
  const double* from = stack_.data() + child.left;
  for (Eigen::Index b = 0; b < blocks; ++b)
    for (Eigen::Index c = 0; c < size; ++c, from += height) {
      double* const to = front_.data() + (child.place[std::size_t(b)] * size + c) * step(s);
      for (Eigen::Index a = b; a < blocks; ++a) {
        double* const rows = to + child.place[std::size_t(a)] * size;
        for (Eigen::Index r = 0; r < size; ++r) rows[r] += from[a * size + r];
      }
    }
}

double BlockLdlt::multiply_adds() const {
  double sum = 0;
  for (const Supernode& s : node_)
    for (Eigen::Index c = 1; c <= s.width * size_; ++c) sum += 0.5 * double(rows(s) - c) * double(rows(s) - c + 1);
  return sum;
}

bool BlockLdlt::factorise(const Sparse& w, const Sparse& blocks) {
  if (!has_pattern_of(w)) analyse(w);
  std::size_t top = 0;
  for (std::size_t k = 0; k < node_.size(); ++k) {
    Supernode& s = node_[k];
    assemble(s, w, blocks);
    for (const Eigen::Index c : child_[k]) add_left(node_[std::size_t(c)], s);
    if (!child_[k].empty()) top = node_[std::size_t(child_[k].front())].left;
    const Eigen::Index columns = s.width * size_, height = rows(s) - columns;
    if (!eliminate(front_.data(), rows(s), step(s), columns, inverse_.data() + s.first * size_)) return false;
    std::copy_n(front_.begin(), columns * step(s), value_.begin() + std::ptrdiff_t(s.value));
    s.left = top;
    top += std::size_t(height * height);
    if (stack_.size() < top) stack_.resize(top);
    for (Eigen::Index c = 0; c < height; ++c)
      copy_column(front_.data() + (columns + c) * step(s) + columns + c, height - c,
                  stack_.data() + s.left + std::size_t(c * height + c));
  }
  return true;
}

void BlockLdlt::solve(VectorXd& x) const {
  VectorXd y(x.size());
  for (std::size_t k = 0; k < order_.size(); ++k)
    y.segment(Eigen::Index(k) * size_, size_) = x.segment(order_[k] * size_, size_);
  Numbers part(largest_step_);
  for (const Supernode& s : node_) forward(s, y.data(), part.data());
  for (std::size_t k = node_.size(); k-- > 0;) backward(node_[k], y.data(), part.data());
  for (std::size_t k = 0; k < order_.size(); ++k)
    x.segment(order_[k] * size_, size_) = y.segment(Eigen::Index(k) * size_, size_);
}

/// part = L^-1 x in the columns, and what they leave in the rows below; four columns at a time.
void BlockLdlt::forward(const Supernode& s, double* y, double* part) const {
  const Eigen::Index columns = s.width * size_, all = step(s);
  std::copy_n(y + s.first * size_, columns, part);
  std::fill(part + columns, part + all, 0.0);
  for (Eigen::Index g = 0; g < columns; g += kGroup) {
    const Eigen::Index count = std::min(kGroup, columns - g);
    Lane::Pack share[kGroup] = {};
    const double* l[kGroup];
    for (Eigen::Index k = 0; k < kGroup; ++k) {
      l[k] = column(s, g + std::min(k, count - 1));
      if (k >= count) continue;
      for (Eigen::Index i = g + k + 1; i < g + kGroup; ++i) part[i] -= l[k][i] * part[g + k];
      share[k] = Lane::fill(-part[g + k]);
    }
    for (Eigen::Index i = g + kGroup; i < all; i += Lane::kWidth) {
      auto sum = Lane::load(part + i);
      for (Eigen::Index k = 0; k < kGroup; ++k) sum = Lane::multiply_add(share[k], Lane::load(l[k] + i), sum);
      Lane::store(part + i, sum);
    }
  }
  std::copy_n(part, columns, y + s.first * size_);
  for (std::size_t b = 0; b < s.row.size(); ++b)
    for (Eigen::Index a = 0; a < size_; ++a) y[s.row[b] * size_ + a] += part[columns + Eigen::Index(b) * size_ + a];
}

void BlockLdlt::backward(const Supernode& s, double* y, double* part) const {
  const Eigen::Index columns = s.width * size_, all = step(s);
  for (Eigen::Index c = 0; c < columns; ++c)
    part[c] = y[s.first * size_ + c] * inverse_[std::size_t(s.first * size_ + c)];
  std::fill(part + columns, part + all, 0.0);
  for (std::size_t b = 0; b < s.row.size(); ++b)
    std::copy_n(y + s.row[b] * size_, size_, part + columns + Eigen::Index(b) * size_);
  for (Eigen::Index g = (columns - 1) / kGroup * kGroup; g >= 0; g -= kGroup) {
    const Eigen::Index count = std::min(kGroup, columns - g);
    Lane::Pack sum[kGroup] = {};
    const double* l[kGroup];
    for (Eigen::Index k = 0; k < kGroup; ++k) l[k] = column(s, g + std::min(k, count - 1));
    for (Eigen::Index i = g + kGroup; i < all; i += Lane::kWidth) {
      const auto x = Lane::load(part + i);
      for (Eigen::Index k = 0; k < kGroup; ++k) sum[k] = Lane::multiply_add(Lane::load(l[k] + i), x, sum[k]);
    }
    for (Eigen::Index k = count - 1; k >= 0; --k) {
      double value = part[g + k] - Lane::sum(sum[k]);
      for (Eigen::Index i = g + k + 1; i < g + kGroup; ++i) value -= l[k][i] * part[i];
      part[g + k] = value;
    }
  }
  std::copy_n(part, columns, y + s.first * size_);
}

}  // namespace gonogo::sim
