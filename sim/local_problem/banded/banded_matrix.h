// A square banded matrix and its factors without exchange of rows.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <vector>

namespace gonogo::sim {

/// Entries (i, j) with |i - j| <= half, row by row; others are 0. Places outside of the matrix hold 0.
template <class Scalar>
struct BandedMatrix {
  Eigen::Index size = 0, half = 0;
  std::vector<Scalar> value;  // [size][2 half + 1], row i from column i - half

  BandedMatrix() = default;
  BandedMatrix(Eigen::Index n, Eigen::Index k) : size(n), half(k), value(std::size_t(n) * std::size_t(2 * k + 1), 0) {}

  Eigen::Index stride() const { return 2 * half + 1; }
  Scalar* row(Eigen::Index i) { return value.data() + i * stride(); }
  const Scalar* row(Eigen::Index i) const { return value.data() + i * stride(); }
  Scalar& at(Eigen::Index i, Eigen::Index j) { return row(i)[half + j - i]; }
  Scalar at(Eigen::Index i, Eigen::Index j) const { return row(i)[half + j - i]; }
};

/// A x.
inline Eigen::VectorXd product(const BandedMatrix<double>& a, const Eigen::VectorXd& x) {
  Eigen::VectorXd y(a.size);
  for (Eigen::Index i = 0; i < a.size; ++i) {
    const Eigen::Index from = std::max<Eigen::Index>(0, i - a.half), to = std::min(a.size - 1, i + a.half);
    y[i] = Eigen::Map<const Eigen::VectorXd>(&a.row(i)[a.half + from - i], to - from + 1)
               .dot(x.segment(from, to - from + 1));
  }
  return y;
}

/// L U = A in place, L with a unit diagonal, rows not exchanged: for matrices that are diagonally dominant or positive
/// definite. A pivot below `least` > 0 is set to +-least (as PARDISO does). Returns how many were.
template <class Scalar>
int factorise_band(BandedMatrix<Scalar>& a, Scalar least) {
  using Row = Eigen::Map<Eigen::Array<Scalar, Eigen::Dynamic, 1>>;
  int boosted = 0;
  for (Eigen::Index k = 0; k < a.size; ++k) {
    Scalar& pivot = a.at(k, k);
    if (!(std::abs(pivot) >= least)) {
      pivot = pivot < 0 ? -least : least;
      ++boosted;
    }
    const Eigen::Index last = std::min(a.size - 1, k + a.half), length = last - k;
    const Row source(a.row(k) + a.half + 1, length);
    for (Eigen::Index i = k + 1; i <= last; ++i) {
      Scalar* const target = &a.at(i, k);
      if (*target == 0) continue;
      const Scalar factor = *target /= pivot;
      Row(target + 1, length) -= factor * source;
    }
  }
  return boosted;
}

/// Rows first .. last - 1 of the forward sweep L X = B in place; X [size x columns], rows contiguous. Rows before
/// `first` of B must be 0.
template <class Scalar, class Rows>
void sweep_forward(const BandedMatrix<Scalar>& lu, Rows& x, Eigen::Index first, Eigen::Index last) {
  for (Eigen::Index i = first; i < last; ++i)
    for (Eigen::Index j = std::max(first, i - lu.half); j < i; ++j)
      if (const Scalar factor = lu.at(i, j); factor != 0) x.row(i) -= factor * x.row(j);
}

/// Rows last - 1 down to first of the backward sweep U X = B in place.
template <class Scalar, class Rows>
void sweep_backward(const BandedMatrix<Scalar>& lu, Rows& x, Eigen::Index first, Eigen::Index last) {
  for (Eigen::Index i = last - 1; i >= first; --i) {
    for (Eigen::Index j = i + 1; j <= std::min(last - 1, i + lu.half); ++j)
      if (const Scalar factor = lu.at(i, j); factor != 0) x.row(i) -= factor * x.row(j);
    x.row(i) /= lu.at(i, i);
  }
}

/// A x = b in place, one right-hand side.
template <class Scalar, class Values>
void solve_band(const BandedMatrix<Scalar>& lu, Values&& x) {
  using Row = Eigen::Map<const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>>;
  for (Eigen::Index i = 1; i < lu.size; ++i) {
    const Eigen::Index from = std::max<Eigen::Index>(0, i - lu.half);
    x[i] -= Row(lu.row(i) + lu.half + from - i, i - from).dot(x.segment(from, i - from));
  }
  for (Eigen::Index i = lu.size - 1; i >= 0; --i) {
    const Eigen::Index length = std::min(lu.size - 1, i + lu.half) - i;
    x[i] = (x[i] - Row(lu.row(i) + lu.half + 1, length).dot(x.segment(i + 1, length))) / lu.at(i, i);
  }
}

}  // namespace gonogo::sim
