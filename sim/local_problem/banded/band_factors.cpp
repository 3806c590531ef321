#include "sim/local_problem/banded/band_factors.h"

#include <cstdlib>

namespace gonogo::sim {
namespace {

constexpr Eigen::Index kPanel = 4;

/// Adds l u to Packs packs of each row of c: from columns 0, kWidth, ... and the last one from column `last`, which may
/// overlap the one before. l: [rows][kPanel]; u: [kPanel][stride].
template <class Scalar, int Packs>
void add_product(Scalar* c, Eigen::Index step, Eigen::Index rows, const Scalar* l, const Scalar* u, Eigen::Index stride,
                 Eigen::Index last) {
  using Lane = Lanes<Scalar>;
  const auto column = [last](int k) { return k + 1 < Packs ? k * Lane::kWidth : last; };
  typename Lane::Pack factor[kPanel][Packs];
  for (int q = 0; q < kPanel; ++q)
    for (int k = 0; k < Packs; ++k) factor[q][k] = Lane::load(u + q * stride + column(k));
  for (Eigen::Index r = 0; r < rows; ++r, c += step, l += kPanel) {
    typename Lane::Pack sum[Packs];
    for (int k = 0; k < Packs; ++k) sum[k] = Lane::load(c + column(k));
    for (int q = 0; q < kPanel; ++q) {
      const auto share = Lane::fill(l[q]);
      for (int k = 0; k < Packs; ++k) sum[k] = Lane::multiply_add(share, factor[q][k], sum[k]);
    }
    for (int k = 0; k < Packs; ++k) Lane::store(c + column(k), sum[k]);
  }
}

/// Adds l u to rows x columns of c, rows `step` apart. l: [rows][kPanel]; u: [kPanel][stride].
template <class Scalar>
void add_block(Scalar* c, Eigen::Index step, Eigen::Index rows, Eigen::Index columns, const Scalar* l, const Scalar* u,
               Eigen::Index stride) {
  constexpr Eigen::Index kWidth = Lanes<Scalar>::kWidth;
  if (columns < kWidth) {
    for (Eigen::Index r = 0; r < rows; ++r)
      for (Eigen::Index q = 0; q < kPanel; ++q)
        for (Eigen::Index k = 0; k < columns; ++k) c[r * step + k] += l[r * kPanel + q] * u[q * stride + k];
    return;
  }
  // Packs go by threes, or by twos where one would be left.
  Eigen::Index left = (columns + kWidth - 1) / kWidth, at = 0;
  while (left > 0) {
    const Eigen::Index packs = left == 2 || left == 4 ? 2 : std::min<Eigen::Index>(left, 3);
    const Eigen::Index last = (left == packs ? columns - kWidth : at + (packs - 1) * kWidth) - at;
    const auto add = packs == 3 ? add_product<Scalar, 3> : packs == 2 ? add_product<Scalar, 2> : add_product<Scalar, 1>;
    add(c + at, step, rows, l, u + at, stride, last);
    left -= packs;
    at += packs * kWidth;
  }
}

/// What a panel leaves for the block C of rows x columns behind it, in the order of memory.
template <class Scalar, int Direction>
class Panel {
 public:
  explicit Panel(const BandWalk<Scalar, Direction>& a)
      : a_(a), l_(std::size_t(kPanel * a.half)), u_(std::size_t(kPanel * a.half)) {}

  int factorise(Eigen::Index from, Scalar least) {
    from_ = from;
    width_ = std::min(kPanel, a_.size - from);
    count_ = std::min(a_.half, a_.size - from - width_);
    const int boosted = diagonal(least);
    if (count_ == 0) return boosted;
    upper();
    lower();
    update();
    return boosted;
  }

 private:
  /// D = L U on the panel's square; its columns' pivots become reciprocals.
  int diagonal(Scalar least) {
    int boosted = 0;
    for (Eigen::Index p = from_; p < from_ + width_; ++p) {
      Scalar& pivot = a_.at(p, p);
      if (!(std::abs(pivot) >= least)) {
        pivot = pivot < 0 ? -least : least;
        ++boosted;
      }
      pivot = 1 / pivot;
      for (Eigen::Index i = p + 1; i < std::min(from_ + width_, p + a_.half + 1); ++i) {
        const Scalar factor = a_.at(i, p) *= pivot;
        for (Eigen::Index j = p + 1; j < std::min(from_ + width_, p + a_.half + 1); ++j)
          a_.at(i, j) -= factor * a_.at(p, j);
      }
    }
    return boosted;
  }

  /// Place of logical column or row c of the block in memory's order.
  Eigen::Index place(Eigen::Index c) const { return Direction > 0 ? c : count_ - 1 - c; }

  /// U = L^-1 A right of the panel, with zeros outside of the band.
  void upper() {
    const Eigen::Index next = from_ + width_;
    for (Eigen::Index q = 0; q < width_; ++q) {
      Scalar* const row = &u_[std::size_t(q * count_)];
      const Eigen::Index inside = std::clamp<Eigen::Index>(from_ + q + a_.half + 1 - next, 0, count_);
      Scalar* const stored = &a_.at(from_ + q, Direction > 0 ? next : next + inside - 1);
      const Eigen::Index begin = Direction > 0 ? 0 : count_ - inside;
      std::fill(row, row + count_, Scalar(0));
      std::copy(stored, stored + inside, row + begin);
      for (Eigen::Index p = std::max<Eigen::Index>(0, q - a_.half); p < q; ++p) {
        const Scalar factor = a_.at(from_ + q, from_ + p);
        const Scalar* const above = &u_[std::size_t(p * count_)];
        for (Eigen::Index c = begin; c < begin + inside; ++c) row[c] -= factor * above[c];
      }
      std::copy(row + begin, row + begin + inside, stored);
    }
  }

  /// L = A U^-1 below the panel; l_ holds -L.
  void lower() {
    const Eigen::Index next = from_ + width_, whole = std::clamp<Eigen::Index>(a_.half - kPanel + 1, 0, count_);
    Scalar u[kPanel][kPanel] = {};
    for (Eigen::Index q = 0; q < width_; ++q)
      for (Eigen::Index s = std::max<Eigen::Index>(0, q - a_.half); s <= q; ++s) u[s][q] = a_.at(from_ + s, from_ + q);
    for (Eigen::Index r = 0; r < whole; ++r) lower_row(next + r, u, &l_[std::size_t(place(r) * kPanel)], 0);
    for (Eigen::Index r = whole; r < count_; ++r)
      lower_row(next + r, u, &l_[std::size_t(place(r) * kPanel)], int(next + r - a_.half - from_));
  }

  /// Row i of L; its entries before `first` lie outside of the band.
  void lower_row(Eigen::Index i, const Scalar (&u)[kPanel][kPanel], Scalar* negative, int first) {
    Scalar* const stored = &a_.at(i, from_);
    Scalar value[kPanel] = {};
    for (int q = 0; q < kPanel; ++q)
      if (q >= first) value[q] = stored[Direction * q];
    for (int q = 0; q < kPanel; ++q) {
      for (int s = 0; s < q; ++s) value[q] -= value[s] * u[s][q];
      value[q] *= u[q][q];
    }
    for (int q = 0; q < kPanel; ++q) {
      if (q >= first) stored[Direction * q] = value[q];
      negative[q] = -value[q];
    }
  }

  /// C -= L U.
  void update() {
    const Eigen::Index next = from_ + width_, end = next + count_ - 1;
    Scalar* const c = Direction > 0 ? &a_.at(next, next) : &a_.at(end, end);
    add_block(c, 2 * a_.half, count_, count_, l_.data(), u_.data(), count_);
  }

  BandWalk<Scalar, Direction> a_;
  std::vector<Scalar> l_, u_;
  Eigen::Index from_ = 0, width_ = 0, count_ = 0;
};

template <class Scalar>
Scalar dot_by_lanes(const Scalar* a, const Scalar* b, Eigen::Index count) {
  using Lane = Lanes<Scalar>;
  auto sum = Lane::fill(0);
  Eigen::Index k = 0;
  for (; k + Lane::kWidth <= count; k += Lane::kWidth)
    sum = Lane::multiply_add(Lane::load(a + k), Lane::load(b + k), sum);
  Scalar rest = 0;
  for (; k < count; ++k) rest += a[k] * b[k];
  return Lane::sum(sum) + rest;
}

/// Sum over j in [from, to) of entry (i, j) times x_j.
template <class Scalar, int Direction>
Scalar row_times(const BandWalk<const Scalar, Direction>& lu, const Scalar* x, Eigen::Index i, Eigen::Index from,
                 Eigen::Index to) {
  if (from >= to) return 0;
  return Direction > 0 ? dot_by_lanes(&lu.at(i, from), x + from, to - from)
                       : dot_by_lanes(&lu.at(i, to - 1), x - (to - 1), to - from);
}

/// Rows whose sums over earlier unknowns are taken side by side.
constexpr Eigen::Index kRows = 4;

}  // namespace

template <class Scalar, int Direction>
int factorise_band(const BandWalk<Scalar, Direction>& a, Scalar least) {
  Panel<Scalar, Direction> panel(a);
  int boosted = 0;
  for (Eigen::Index from = 0; from < a.size; from += kPanel) boosted += panel.factorise(from, least);
  return boosted;
}

template <class Scalar, int Direction>
void sweep_forward(const BandWalk<const Scalar, Direction>& lu, Scalar* x) {
  for (Eigen::Index first = 0; first < lu.size; first += kRows) {
    const Eigen::Index end = std::min(lu.size, first + kRows);
    for (Eigen::Index i = first; i < end; ++i)
      x[Direction * i] -= row_times<Scalar, Direction>(lu, x, i, std::max<Eigen::Index>(0, i - lu.half), first);
    for (Eigen::Index i = first + 1; i < end; ++i)
      for (Eigen::Index j = std::max(first, i - lu.half); j < i; ++j)
        x[Direction * i] -= lu.at(i, j) * x[Direction * j];
  }
}

template <class Scalar, int Direction>
void sweep_backward(const BandWalk<const Scalar, Direction>& lu, Scalar* x) {
  for (Eigen::Index end = lu.size; end > 0; end -= kRows) {
    const Eigen::Index first = std::max<Eigen::Index>(0, end - kRows);
    for (Eigen::Index i = first; i < end; ++i)
      x[Direction * i] -= row_times<Scalar, Direction>(lu, x, i, end, std::min(lu.size, i + lu.half + 1));
    for (Eigen::Index i = end - 1; i >= first; --i) {
      for (Eigen::Index j = std::min(end - 1, i + lu.half); j > i; --j)
        x[Direction * i] -= lu.at(i, j) * x[Direction * j];
      x[Direction * i] *= lu.at(i, i);
    }
  }
}

namespace {

/// Rows of right-hand sides in the order of a walk.
template <class Scalar, int Direction>
class Sweep {
 public:
  Sweep(const BandWalk<const Scalar, Direction>& lu, Scalar* x, Eigen::Index columns)
      : lu_(lu), x_(x), columns_(columns), l_(std::size_t(kPanel * lu.half)) {}

  /// Row i less `factor` times row j.
  void take_row(Eigen::Index i, Eigen::Index j) {
    const Scalar factor = lu_.at(i, j);
    Scalar *const to = x_ + i * columns_, *const from = x_ + j * columns_;
    for (Eigen::Index k = 0; k < columns_; ++k) to[k] -= factor * from[k];
  }
  void scale_row(Eigen::Index i) {
    const Scalar factor = lu_.at(i, i);
    for (Eigen::Index k = 0; k < columns_; ++k) x_[i * columns_ + k] *= factor;
  }
  /// Rows [begin, end) less their factors times the rows of a whole panel.
  void take_panel(Eigen::Index panel, Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index i = begin; i < end; ++i)
      for (Eigen::Index q = 0; q < kPanel; ++q) {
        const bool inside = std::abs(i - (panel + q)) <= lu_.half;
        l_[std::size_t((i - begin) * kPanel + q)] = inside ? -lu_.at(i, panel + q) : Scalar(0);
      }
    add_block(x_ + begin * columns_, columns_, end - begin, columns_, l_.data(), x_ + panel * columns_, columns_);
  }

 private:
  const BandWalk<const Scalar, Direction>& lu_;
  Scalar* x_;
  Eigen::Index columns_;
  std::vector<Scalar> l_;
};

}  // namespace

template <class Scalar, int Direction>
void sweep_rows_forward(const BandWalk<const Scalar, Direction>& lu, Scalar* x, Eigen::Index columns,
                        Eigen::Index first) {
  Sweep<Scalar, Direction> sweep(lu, x, columns);
  for (Eigen::Index panel = first; panel < lu.size; panel += kPanel) {
    const Eigen::Index next = std::min(lu.size, panel + kPanel), end = std::min(lu.size, next + lu.half);
    for (Eigen::Index i = panel + 1; i < next; ++i)
      for (Eigen::Index j = std::max(panel, i - lu.half); j < i; ++j) sweep.take_row(i, j);
    if (next < end) sweep.take_panel(panel, next, end);
  }
}

template <class Scalar, int Direction>
void sweep_rows_backward(const BandWalk<const Scalar, Direction>& lu, Scalar* x, Eigen::Index columns) {
  Sweep<Scalar, Direction> sweep(lu, x, columns);
  for (Eigen::Index next = lu.size; next > 0; next -= kPanel) {
    const Eigen::Index panel = std::max<Eigen::Index>(0, next - kPanel),
                       begin = std::max<Eigen::Index>(0, panel - lu.half);
    for (Eigen::Index i = next - 1; i >= panel; --i) {
      for (Eigen::Index j = i + 1; j < std::min(next, i + lu.half + 1); ++j) sweep.take_row(i, j);
      sweep.scale_row(i);
    }
    if (begin < panel) sweep.take_panel(panel, begin, panel);
  }
}

// NOLINTBEGIN(bugprone-macro-parentheses): a type in parentheses would not name one
#define GONOGO_INSTANTIATE(Scalar, Direction)                                                                      \
  template int factorise_band(const BandWalk<Scalar, Direction>&, Scalar);                                         \
  template void sweep_forward(const BandWalk<const Scalar, Direction>&, Scalar*);                                  \
  template void sweep_backward(const BandWalk<const Scalar, Direction>&, Scalar*);                                 \
  template void sweep_rows_forward(const BandWalk<const Scalar, Direction>&, Scalar*, Eigen::Index, Eigen::Index); \
  template void sweep_rows_backward(const BandWalk<const Scalar, Direction>&, Scalar*, Eigen::Index)
// NOLINTEND(bugprone-macro-parentheses)
GONOGO_INSTANTIATE(float, 1);
GONOGO_INSTANTIATE(float, -1);
GONOGO_INSTANTIATE(double, 1);
GONOGO_INSTANTIATE(double, -1);
#undef GONOGO_INSTANTIATE

}  // namespace gonogo::sim
