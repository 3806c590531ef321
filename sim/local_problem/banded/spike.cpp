#include "sim/local_problem/banded/spike.h"

#include <algorithm>
#include <limits>

namespace gonogo::sim {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// Rows and columns in reverse order, so that LU of it is UL of the block.
template <class Scalar>
BandedMatrix<Scalar> reversed(const BandedMatrix<Scalar>& a) {
  BandedMatrix<Scalar> out = a;
  std::reverse(out.value.begin(), out.value.end());
  return out;
}

/// The last `count` rows of the factors of `lu`.
template <class Scalar>
BandedMatrix<Scalar> tail(const BandedMatrix<Scalar>& lu, Index count) {
  BandedMatrix<Scalar> out(count, lu.half);
  std::copy(lu.value.end() - std::ptrdiff_t(count * lu.stride()), lu.value.end(), out.value.begin());
  return out;
}

}  // namespace

template <class Scalar>
Spike<Scalar>::Spike(const BandedMatrix<double>& a, const SpikeSettings& settings)
    : half_(a.half), kind_(settings.kind) {
  const Index most = half_ > 0 ? std::max<Index>(1, a.size / (2 * half_)) : 1;
  const Index count = std::clamp<Index>(settings.partitions, 1, std::max<Index>(1, most));
  part_.resize(std::size_t(count));
  double largest = 0;
  for (const double value : a.value) largest = std::max(largest, std::abs(value));
  const Scalar epsilon = std::numeric_limits<Scalar>::epsilon();
  const Scalar least = std::max(Scalar(largest) * epsilon, std::numeric_limits<Scalar>::min());
  for (Index p = 0; p < count; ++p) {
    part_[std::size_t(p)].first = a.size * p / count;
    part_[std::size_t(p)].size = a.size * (p + 1) / count - a.size * p / count;
  }
#pragma omp parallel for schedule(static)
  for (Index p = 0; p < count; ++p) factorise(a, part_[std::size_t(p)], kind_, least);
  for (const Part& part : part_) boosted_ += part.boosted;
  join();
}

template <class Scalar>
void Spike<Scalar>::factorise(const BandedMatrix<double>& a, Part& part, SpikeKind kind, Scalar least) const {
  const Index first = part.first, end = first + part.size, k = half_;
  BandedMatrix<Scalar> block(part.size, k);
  if (first > 0) part.c = Dense::Zero(k, k);
  if (end < a.size) part.b = Dense::Zero(k, k);
  for (Index i = first; i < end; ++i)
    for (Index j = std::max<Index>(0, i - k); j <= std::min(a.size - 1, i + k); ++j) {
      const Scalar value = Scalar(a.at(i, j));
      if (j < first)
        part.c(i - first, j - (first - k)) = value;
      else if (j >= end)
        part.b(i - (end - k), j - end) = value;
      else
        block.at(i - first, j - first) = value;
    }
  part.lu = block;
  part.boosted = factorise_band(part.lu, least);
  find_tips(block, part, kind, least);
}

template <class Scalar>
void Spike<Scalar>::find_tips(const BandedMatrix<Scalar>& block, Part& part, SpikeKind kind, Scalar least) const {
  const Index n = part.size, k = half_;
  if (kind == SpikeKind::full) {
    if (part.b.size() > 0) {  // above the last rows, L^-1 (0, B) is 0
      Dense v = Dense::Zero(n, k);
      v.bottomRows(k) = part.b;
      sweep_forward(part.lu, v, n - k, n);
      sweep_backward(part.lu, v, 0, n);
      part.v_top = v.topRows(k);
      part.v_bottom = v.bottomRows(k);
    }
    if (part.c.size() > 0) {
      Dense w = Dense::Zero(n, k);
      w.topRows(k) = part.c;
      sweep_forward(part.lu, w, 0, n);
      sweep_backward(part.lu, w, 0, n);
      part.w_top = w.topRows(k);
      part.w_bottom = w.bottomRows(k);
    }
    return;
  }
  const auto corner = [&](const BandedMatrix<Scalar>& lu, const Dense& coupling) {
    const BandedMatrix<Scalar> end = tail(lu, k);
    Dense x = coupling;
    sweep_forward(end, x, 0, k);
    sweep_backward(end, x, 0, k);
    return x;
  };
  if (part.b.size() > 0) part.v_bottom = corner(part.lu, part.b);
  if (part.c.size() > 0) {  // the top corner is the bottom one of the reversed block
    BandedMatrix<Scalar> ul = reversed(block);
    factorise_band(ul, least);
    part.w_top = corner(ul, part.c.colwise().reverse()).colwise().reverse();
  }
}

template <class Scalar>
void Spike<Scalar>::join() {
  const Index k = half_;
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

/// y [2 half x joints]: bottoms and tops that the joints ask for, from g = A_p^-1 f_p.
template <class Scalar>
void Spike<Scalar>::solve_joints(const Vector& g, Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>& y) const {
  const Index k = half_;
  const bool full = kind_ == SpikeKind::full;
  y.resize(2 * k, Index(joint_.size()));
  for (Index p = 0; p < y.cols(); ++p) {
    const Index boundary = part_[std::size_t(p) + 1].first;
    y.col(p) = g.segment(boundary - k, 2 * k);
    if (full && p > 0) y.col(p).head(k) -= part_[std::size_t(p)].w_bottom * y.col(p - 1).head(k);
    y.col(p) = joint_[std::size_t(p)].lu.solve(y.col(p)).eval();
  }
  for (Index p = y.cols() - 2; full && p >= 0; --p) y.col(p) -= joint_[std::size_t(p)].next * y.col(p + 1).tail(k);
}

template <class Scalar>
void Spike<Scalar>::solve(Vector& b) const {
  const Index k = half_, count = Index(part_.size());
  const auto solve_parts = [&](Vector& x) {
#pragma omp parallel for schedule(static)
    for (Index p = 0; p < count; ++p) {
      const Part& part = part_[std::size_t(p)];
      solve_band(part.lu, x.segment(part.first, part.size));
    }
  };
  if (count == 1) return solve_parts(b);
  Vector g = b;
  solve_parts(g);
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> y;
  solve_joints(g, y);
  for (Index p = 0; p < count; ++p) {
    const Part& part = part_[std::size_t(p)];
    if (p + 1 < count) b.segment(part.first + part.size - k, k) -= part.b * y.col(p).tail(k);
    if (p > 0) b.segment(part.first, k) -= part.c * y.col(p - 1).head(k);
  }
  solve_parts(b);
}

template <class Scalar>
std::size_t Spike<Scalar>::bytes() const {
  std::size_t values = 0;
  for (const Part& part : part_)
    values += part.lu.value.size() + std::size_t(part.b.size() + part.c.size() + part.v_top.size() +
                                                 part.v_bottom.size() + part.w_top.size() + part.w_bottom.size());
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
