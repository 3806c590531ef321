#include "sim/local_problem/banded/spike.h"
#include "base/parallel/host_loop.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

namespace gonogo::sim {

using Eigen::VectorXd;

namespace {

/// Tail of A^-1 (0, coupling) from the factors' tail alone, in the order of the walk.
template <class Walk, class Dense>
Dense corner(const Walk& lu, const Dense& coupling) {
  const Walk end = lu.tail(coupling.rows());
  Dense x = coupling;
  sweep_rows_forward(end, x.data(), x.cols(), 0);
  sweep_rows_backward(end, x.data(), x.cols());
  return x;
}

/// Rows from the first to the last, in the order of a walk up.
template <class Dense>
Dense flipped(const Dense& x) {
  return x.colwise().reverse();
}

template <class Scalar>
BandedMatrix<Scalar> converted(BandedMatrix<double> a) {
  if constexpr (std::is_same_v<Scalar, double>) {
    return a;
  } else {
    BandedMatrix<Scalar> out(a.size, a.half);
    std::copy(a.value.begin(), a.value.end(), out.value.begin());
    return out;
  }
}

}  // namespace

template <class Scalar>
Spike<Scalar>::Spike(BandedMatrix<double> a, const SpikeSettings& settings)
    : half_(a.half), band_(converted<Scalar>(std::move(a))), kind_(settings.kind) {
  const Eigen::Index n = band_.size, most = half_ > 0 ? std::max<Eigen::Index>(1, n / (2 * half_)) : 1;
  const Eigen::Index count = std::clamp<Eigen::Index>(settings.partitions, 1, most);
  part_.resize(std::size_t(count));
  Scalar largest = 0;
  for (Eigen::Index i = 0; i < n; ++i) largest = std::max(largest, std::abs(band_.at(i, i)));
  const Scalar least = std::max(largest * std::numeric_limits<Scalar>::epsilon(), std::numeric_limits<Scalar>::min());
  for (Eigen::Index p = 0; p < count; ++p) {
    part_[std::size_t(p)].first = n * p / count;
    part_[std::size_t(p)].size = n * (p + 1) / count - n * p / count;
  }
  for_each_on_host(part_.size(), 1, [&](std::size_t p) {
    take_coupling(part_[p]);
    factorise(part_[p], least);
  });
  for (const Part& part : part_) boosted_ += part.boosted;
  join();
}

/// Moves what lies outside of the partition's square out of its rows.
template <class Scalar>
void Spike<Scalar>::take_coupling(Part& part) {
  const Eigen::Index k = half_, end = part.first + part.size;
  if (part.first > 0) {
    part.c = Dense::Zero(k, k);
    for (Eigen::Index i = 0; i < k; ++i)
      for (Eigen::Index m = 0; m < k - i; ++m) std::swap(part.c(i, i + m), band_.row(part.first + i)[m]);
  }
  if (end < band_.size) {
    part.b = Dense::Zero(k, k);
    for (Eigen::Index i = 0; i < k; ++i)
      for (Eigen::Index m = 2 * k - i; m <= 2 * k; ++m) std::swap(part.b(i, i + m - 2 * k), band_.row(end - k + i)[m]);
  }
}

template <class Scalar>
void Spike<Scalar>::factorise(Part& part, Scalar least) {
  Scalar* const rows = band_.row(part.first);
  if (is_last(part)) {
    part.boosted = factorise_band(walk_up(rows, part.size, half_), least);
    part.w_top = flipped<Dense>(corner(up(part), flipped<Dense>(part.c)));
    return;
  }
  const bool between = !is_first(part);
  if (between && kind_ == SpikeKind::truncated) {
    std::vector<Scalar> copy(rows, rows + part.size * band_.stride());
    factorise_band(walk_up(copy.data(), part.size, half_), least);
    const auto ul = walk_up(std::as_const(copy).data(), part.size, half_);
    part.w_top = flipped<Dense>(corner(ul, flipped<Dense>(part.c)));
  }
  part.boosted = factorise_band(walk_down(rows, part.size, half_), least);
  if (between && kind_ == SpikeKind::full)
    find_spikes(part);
  else if (part.b.size() > 0)
    part.v_bottom = corner(down(part), part.b);
}

template <class Scalar>
void Spike<Scalar>::find_spikes(Part& part) const {
  const Eigen::Index n = part.size, k = half_;
  const auto lu = down(part);
  Dense x = Dense::Zero(n, k);
  x.bottomRows(k) = part.b;
  sweep_rows_forward(lu, x.data(), k, n - k);  // above the last rows, L^-1 (0, B) is 0
  sweep_rows_backward(lu, x.data(), k);
  part.v_top = x.topRows(k);
  part.v_bottom = x.bottomRows(k);
  x.setZero();
  x.topRows(k) = part.c;
  sweep_rows_forward(lu, x.data(), k, 0);
  sweep_rows_backward(lu, x.data(), k);
  part.w_top = x.topRows(k);
  part.w_bottom = x.bottomRows(k);
}

template <class Scalar>
void Spike<Scalar>::join() {
  const Eigen::Index k = half_;
  joint_.resize(part_.size() - 1);
  for (std::size_t p = 0; p < joint_.size(); ++p) {
    Dense block = Dense::Identity(2 * k, 2 * k);
    block.topRightCorner(k, k) = part_[p].v_bottom;
    block.bottomLeftCorner(k, k) = part_[p + 1].w_top;
    const bool full = kind_ == SpikeKind::full;
    if (full && p > 0)  // bottom of p - 1 is its right-hand side less `next` times the top of p + 1
      block.topRightCorner(k, k) -= part_[p].w_bottom * joint_[p - 1].next.topRows(k);
    joint_[p].lu.compute(block);
    if (!full || p + 1 == joint_.size()) continue;
    Dense coupling = Dense::Zero(2 * k, k);
    coupling.bottomRows(k) = part_[p + 1].v_top;
    joint_[p].next = joint_[p].lu.solve(coupling);
  }
}

/// Bottoms and tops at the joints [2 half x joints] from those of A_p^-1 f_p.
template <class Scalar>
auto Spike<Scalar>::solve_joints(const Columns& tips) const -> Columns {
  const Eigen::Index k = half_;
  const bool full = kind_ == SpikeKind::full;
  Columns y(2 * k, Eigen::Index(joint_.size()));
  for (Eigen::Index p = 0; p < y.cols(); ++p) {
    y.col(p) << tips.col(p).tail(k), tips.col(p + 1).head(k);
    if (full && p > 0) y.col(p).head(k) -= part_[std::size_t(p)].w_bottom * y.col(p - 1).head(k);
    y.col(p) = joint_[std::size_t(p)].lu.solve(y.col(p)).eval();
  }
  for (Eigen::Index p = y.cols() - 2; full && p >= 0; --p)
    y.col(p) -= joint_[std::size_t(p)].next * y.col(p + 1).tail(k);
  return y;
}

/// Top and bottom of A_p^-1 f_p; those that no joint asks for stay 0. x: f_p, in the first and the last partition
/// replaced by what the forward sweep makes of it.
template <class Scalar>
void Spike<Scalar>::begin(const Part& part, Scalar* x, Vector& tips) const {
  const Eigen::Index k = half_, n = part.size;
  tips = Vector::Zero(2 * k);
  if (is_first(part)) {
    sweep_forward(down(part), x);
    tips.tail(k) = Eigen::Map<const Vector>(x + n - k, k);
    sweep_backward(down(part).tail(k), tips.data() + k);
  } else if (is_last(part)) {
    sweep_forward(up(part), x + n - 1);
    tips.head(k) = Eigen::Map<const Vector>(x, k);
    sweep_backward(up(part).tail(k), tips.data() + k - 1);
  } else {
    Vector g = Eigen::Map<const Vector>(x, n);
    sweep_forward(down(part), g.data());
    sweep_backward(down(part), g.data());
    tips << g.head(k), g.tail(k);
  }
}

/// x_p from what `begin` left, less C times the bottom before (at_top) and B times the top behind (at_bottom).
template <class Scalar>
void Spike<Scalar>::finish(const Part& part, const Vector& at_top, const Vector& at_bottom, Scalar* x) const {
  const Eigen::Index k = half_, n = part.size;
  Eigen::Map<Vector> values(x, n);
  if (is_first(part)) {
    Vector swept = at_bottom;
    sweep_forward(down(part).tail(k), swept.data());
    values.tail(k) -= swept;
    sweep_backward(down(part), x);
  } else if (is_last(part)) {
    Vector swept = at_top;
    sweep_forward(up(part).tail(k), swept.data() + k - 1);
    values.head(k) -= swept;
    sweep_backward(up(part), x + n - 1);
  } else {
    values.head(k) -= at_top;
    values.tail(k) -= at_bottom;
    sweep_forward(down(part), x);
    sweep_backward(down(part), x);
  }
}

template <class Scalar>
void Spike<Scalar>::solve(Vector& b) const {
  const Eigen::Index k = half_, count = Eigen::Index(part_.size());
  if (count == 1) {
    sweep_forward(down(part_[0]), b.data());
    sweep_backward(down(part_[0]), b.data());
    return;
  }
  Columns tips(2 * k, count);
  for_each_on_host(part_.size(), 1, [&](std::size_t p) {
    Vector found;
    begin(part_[p], b.data() + part_[p].first, found);
    tips.col(Eigen::Index(p)) = found;
  });
  const Columns y = solve_joints(tips);
  for_each_on_host(part_.size(), 1, [&](std::size_t index) {
    const Part& part = part_[index];
    const auto p = Eigen::Index(index);
    Vector at_top, at_bottom;
    if (p > 0) at_top = part.c * y.col(p - 1).head(k);
    if (p + 1 < count) at_bottom = part.b * y.col(p).tail(k);
    finish(part, at_top, at_bottom, b.data() + part.first);
  });
}

template <class Scalar>
std::size_t Spike<Scalar>::bytes() const {
  std::size_t values = band_.value.size();
  for (const Part& part : part_)
    values += std::size_t(part.b.size() + part.c.size() + part.v_top.size() + part.v_bottom.size() + part.w_top.size() +
                          part.w_bottom.size());
  for (const Joint& joint : joint_) values += std::size_t(joint.lu.matrixLU().size() + joint.next.size());
  return values * sizeof(Scalar);
}

template <class Scalar>
Refined refine(const BandedMatrix<double>& a, const Spike<Scalar>& spike, const VectorXd& b, double tolerance,
               int max) {
  Refined best{.x = VectorXd::Zero(b.size()), .residual = 1};
  const double scale = b.norm();
  VectorXd x = best.x, rest = b;
  while (best.iterations < max && scale > 0 && best.residual > tolerance) {
    const double size = rest.lpNorm<Eigen::Infinity>();  // float holds no small residuals: they are scaled
    typename Spike<Scalar>::Vector step = (rest / size).template cast<Scalar>();
    spike.solve(step);
    x += size * step.template cast<double>();
    ++best.iterations;
    rest = b - product(a, x);
    const double residual = rest.norm() / scale;
    if (!(residual < best.residual)) break;
    const bool halves = residual < best.residual / 2;
    best.x = x;
    best.residual = residual;
    if (!halves) break;
  }
  return best;
}

template class Spike<double>;
template class Spike<float>;
template Refined refine(const BandedMatrix<double>&, const Spike<double>&, const VectorXd&, double, int);
template Refined refine(const BandedMatrix<double>&, const Spike<float>&, const VectorXd&, double, int);

}  // namespace gonogo::sim
