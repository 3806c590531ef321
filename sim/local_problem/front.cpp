#include "sim/local_problem/front.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/local_problem/banded/lanes.h"

namespace gonogo::sim {
namespace {

using Eigen::Index;
using Lane = Lanes<double>;
using Columns = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

constexpr Index kPanel = 4;
/// Fronts beyond this go by blocks of columns, whose products Eigen multiplies.
constexpr Index kSmall = 192, kBlock = 64;

class Front {
 public:
  Front(double* f, Index rows, Index step, double* inverse) : f_(f), rows_(rows), step_(step), inverse_(inverse) {}

  /// Columns [begin, end) eliminated from the columns before `last`. `begin`: a multiple of kPanel.
  bool panels(Index begin, Index end, Index last) {
    for (Index p = begin; p < end; p += kPanel) {
      const Index count = std::min(kPanel, end - p);
      const bool done = count == 4   ? panel<4>(p, last)
                        : count == 3 ? panel<3>(p, last)
                        : count == 2 ? panel<2>(p, last)
                                     : panel<1>(p, last);
      if (!done) return false;
    }
    return true;
  }

  /// The Schur complement behind `end`, of columns [begin, end).
  void take_block(Index begin, Index end) {
    const Index count = end - begin;
    Eigen::MatrixXd scaled;
    for (Index c = end; c < rows_; c += kBlock) {
      const Index width = std::min(kBlock, rows_ - c);
      const Columns l(f_ + begin * step_ + c, rows_ - c, count, Eigen::OuterStride<>(step_));
      scaled.resize(count, width);
      for (Index k = 0; k < count; ++k)
        for (Index j = 0; j < width; ++j) scaled(k, j) = l(j, k) * f_[(begin + k) * step_ + begin + k];
      Columns(f_ + c * step_ + c, rows_ - c, width, Eigen::OuterStride<>(step_)).noalias() -= l * scaled;
    }
  }

 private:
  template <int Count>
  bool panel(Index p, Index last) {
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
    for (Index i = p; i < step_; i += Lane::kWidth) {
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
  void take(Index p, Index first, Index last) {
    Index c = first;
    for (; c + 2 <= last; c += 2) take_from<Count, 2>(p, c);
    if (c < last) take_from<Count, 1>(p, c);
  }

  /// From Width columns at once, in whole packs from a row at or above the diagonal.
  template <int Count, int Width>
  void take_from(Index p, Index c) {
    Lane::Pack share[Width][Count];
    for (int k = 0; k < Count; ++k)
      for (int w = 0; w < Width; ++w)
        share[w][k] = Lane::fill(-f_[(p + k) * step_ + c + w] * f_[(p + k) * step_ + p + k]);
    for (Index i = c / Lane::kWidth * Lane::kWidth; i < step_; i += Lane::kWidth) {
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
  Index rows_, step_;
  double* inverse_;
};

}  // namespace

bool eliminate(double* f, Index rows, Index step, Index count, double* inverse) {
  Front front(f, rows, step, inverse);
  if (rows <= kSmall) return front.panels(0, count, rows);
  for (Index begin = 0; begin < count; begin += kBlock) {
    const Index end = std::min(count, begin + kBlock);
    if (!front.panels(begin, end, end)) return false;
    front.take_block(begin, end);
  }
  return true;
}

}  // namespace gonogo::sim
