#include "sim/local_problem/block_ldlt.h"

#include <algorithm>

#include "sim/local_problem/banded/lanes.h"
#include "sim/local_problem/block_pattern.h"
#include "sim/local_problem/front.h"

namespace gonogo::sim {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

using Index = Eigen::Index;

/// Columns that sweeps take at once: a pack's width, so that the rows behind a group begin with a whole pack.
constexpr Index kGroup = Lanes<double>::kWidth;

using Lane = Lanes<double>;

// Columns are short: a call of memset or memmove would cost more than the work.
void clear_packs(double* from, const double* to) {
  for (; from < to; from += Lane::kWidth) Lane::store(from, Lane::Pack{});
}
void copy_column(const double* from, Index count, double* to) {
  Index i = 0;
  for (; i + Lane::kWidth <= count; i += Lane::kWidth) Lane::store(to + i, Lane::load(from + i));
  for (; i < count; ++i) to[i] = from[i];
}

/// One entry per block of `size` rows.
Sparse block_graph(const Sparse& a, Index size) {
  std::vector<Eigen::Triplet<double>> entry;
  for (Index k = 0; k < a.outerSize(); ++k)
    for (Sparse::InnerIterator it(a, k); it; ++it) entry.emplace_back(it.row() / size, it.col() / size, 1);
  for (Index k = 0; k < a.rows() / size; ++k) entry.emplace_back(k, k, 1);
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
  std::vector<Index> node_of(order_.size()), place_of(order_.size());
  std::size_t values = 0;
  for (const ColumnGroup& g : pattern.group) {
    for (Index k = 0; k < g.width; ++k) node_of[std::size_t(g.first + k)] = Index(node_.size());
    node_.push_back({.first = g.first, .width = g.width, .row = g.row, .value = values});
    values += std::size_t(g.width * size_ * step(node_.back()));
  }
  value_.resize(values);
  inverse_.resize(std::size_t(w.rows()));
  for (std::size_t k = 0; k < order_.size(); ++k) place_of[std::size_t(order_[k])] = Index(k);
  child_.assign(node_.size(), {});
  Index largest = 0;
  for (std::size_t k = 0; k < node_.size(); ++k) {
    Supernode& s = node_[k];
    largest = std::max(largest, rows(s) * step(s));
    largest_step_ = std::max(largest_step_, std::size_t(step(s)));
    if (s.row.empty()) continue;
    s.parent = node_of[std::size_t(s.row[0])];
    child_[std::size_t(s.parent)].push_back(Index(k));
    for (const Index row : s.row) s.place.push_back(block_of(node_[std::size_t(s.parent)], row));
  }
  front_.resize(std::size_t(largest));
  place_entries(w, node_of, place_of);
}

void BlockLdlt::place_entries(const Sparse& w, const std::vector<Index>& node_of, const std::vector<Index>& place_of) {
  for (Index k = 0; k < w.outerSize(); ++k) {
    const Index column = place_of[std::size_t(k / size_)];
    Supernode& s = node_[std::size_t(node_of[std::size_t(column)])];
    const Index base = ((column - s.first) * size_ + k % size_) * step(s);
    Index latest = -1, block = 0;
    for (Index at = begin_[std::size_t(k)]; at < begin_[std::size_t(k) + 1]; ++at) {
      const Index i = inner_[std::size_t(at)], row = place_of[std::size_t(i / size_)];
      if (row < column || (row == column && i < k)) continue;
      if (row != latest) block = block_of(s, row);
      latest = row;
      s.entry.push_back({int(at), int(base + block * size_ + i % size_)});
    }
  }
}

/// Of a row among the blocks of a front.
Eigen::Index BlockLdlt::block_of(const Supernode& s, Index row) {
  if (row < s.first + s.width) return row - s.first;
  return s.width + (std::lower_bound(s.row.begin(), s.row.end(), row) - s.row.begin());
}

void BlockLdlt::assemble(const Supernode& s, const Sparse& w, const Sparse& blocks) {
  for (Index c = 0; c < rows(s); ++c)  // the lower triangle
    clear_packs(front_.data() + c * step(s) + c / kGroup * kGroup, front_.data() + (c + 1) * step(s));
  for (const Entry& e : s.entry) front_[std::size_t(e.to)] = w.valuePtr()[e.from];
  for (Index b = 0; b < s.width; ++b)
    for (Index c = 0; c < size_; ++c)
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
void BlockLdlt::add_blocks_left(const Supernode& child, const Supernode& s, Index any_size) {
  const Index size = Size > 0 ? Size : any_size, blocks = Index(child.row.size()), height = blocks * size;
  const double* from = stack_.data() + child.left;
  for (Index b = 0; b < blocks; ++b)
    for (Index c = 0; c < size; ++c, from += height) {
      double* const to = front_.data() + (child.place[std::size_t(b)] * size + c) * step(s);
      for (Index a = b; a < blocks; ++a) {
        double* const rows = to + child.place[std::size_t(a)] * size;
        for (Index r = 0; r < size; ++r) rows[r] += from[a * size + r];
      }
    }
}

double BlockLdlt::multiply_adds() const {
  double sum = 0;
  for (const Supernode& s : node_)
    for (Index c = 1; c <= s.width * size_; ++c) sum += 0.5 * double(rows(s) - c) * double(rows(s) - c + 1);
  return sum;
}

bool BlockLdlt::factorise(const Sparse& w, const Sparse& blocks) {
  if (!has_pattern_of(w)) analyse(w);
  std::size_t top = 0;
  for (std::size_t k = 0; k < node_.size(); ++k) {
    Supernode& s = node_[k];
    assemble(s, w, blocks);
    for (const Index c : child_[k]) add_left(node_[std::size_t(c)], s);
    if (!child_[k].empty()) top = node_[std::size_t(child_[k].front())].left;
    const Index columns = s.width * size_, height = rows(s) - columns;
    if (!eliminate(front_.data(), rows(s), step(s), columns, inverse_.data() + s.first * size_)) return false;
    std::copy_n(front_.begin(), columns * step(s), value_.begin() + std::ptrdiff_t(s.value));
    s.left = top;
    top += std::size_t(height * height);
    if (stack_.size() < top) stack_.resize(top);
    for (Index c = 0; c < height; ++c)
      copy_column(front_.data() + (columns + c) * step(s) + columns + c, height - c,
                  stack_.data() + s.left + std::size_t(c * height + c));
  }
  return true;
}

void BlockLdlt::solve(VectorXd& x) const {
  VectorXd y(x.size());
  for (std::size_t k = 0; k < order_.size(); ++k)
    y.segment(Index(k) * size_, size_) = x.segment(order_[k] * size_, size_);
  Numbers part(largest_step_);
  for (const Supernode& s : node_) forward(s, y.data(), part.data());
  for (std::size_t k = node_.size(); k-- > 0;) backward(node_[k], y.data(), part.data());
  for (std::size_t k = 0; k < order_.size(); ++k)
    x.segment(order_[k] * size_, size_) = y.segment(Index(k) * size_, size_);
}

/// part = L^-1 x in the columns, and what they leave in the rows below; four columns at a time.
void BlockLdlt::forward(const Supernode& s, double* y, double* part) const {
  const Index columns = s.width * size_, all = step(s);
  std::copy_n(y + s.first * size_, columns, part);
  std::fill(part + columns, part + all, 0.0);
  for (Index g = 0; g < columns; g += kGroup) {
    const Index count = std::min(kGroup, columns - g);
    Lane::Pack share[kGroup] = {};
    const double* l[kGroup];
    for (Index k = 0; k < kGroup; ++k) {
      l[k] = column(s, g + std::min(k, count - 1));
      if (k >= count) continue;
      for (Index i = g + k + 1; i < g + kGroup; ++i) part[i] -= l[k][i] * part[g + k];
      share[k] = Lane::fill(-part[g + k]);
    }
    for (Index i = g + kGroup; i < all; i += Lane::kWidth) {
      auto sum = Lane::load(part + i);
      for (Index k = 0; k < kGroup; ++k) sum = Lane::multiply_add(share[k], Lane::load(l[k] + i), sum);
      Lane::store(part + i, sum);
    }
  }
  std::copy_n(part, columns, y + s.first * size_);
  for (std::size_t b = 0; b < s.row.size(); ++b)
    for (Index a = 0; a < size_; ++a) y[s.row[b] * size_ + a] += part[columns + Index(b) * size_ + a];
}

void BlockLdlt::backward(const Supernode& s, double* y, double* part) const {
  const Index columns = s.width * size_, all = step(s);
  for (Index c = 0; c < columns; ++c) part[c] = y[s.first * size_ + c] * inverse_[std::size_t(s.first * size_ + c)];
  std::fill(part + columns, part + all, 0.0);
  for (std::size_t b = 0; b < s.row.size(); ++b)
    std::copy_n(y + s.row[b] * size_, size_, part + columns + Index(b) * size_);
  for (Index g = (columns - 1) / kGroup * kGroup; g >= 0; g -= kGroup) {
    const Index count = std::min(kGroup, columns - g);
    Lane::Pack sum[kGroup] = {};
    const double* l[kGroup];
    for (Index k = 0; k < kGroup; ++k) l[k] = column(s, g + std::min(k, count - 1));
    for (Index i = g + kGroup; i < all; i += Lane::kWidth) {
      const auto x = Lane::load(part + i);
      for (Index k = 0; k < kGroup; ++k) sum[k] = Lane::multiply_add(Lane::load(l[k] + i), x, sum[k]);
    }
    for (Index k = count - 1; k >= 0; --k) {
      double value = part[g + k] - Lane::sum(sum[k]);
      for (Index i = g + k + 1; i < g + kGroup; ++i) value -= l[k][i] * part[i];
      part[g + k] = value;
    }
  }
  std::copy_n(part, columns, y + s.first * size_);
}

}  // namespace gonogo::sim
