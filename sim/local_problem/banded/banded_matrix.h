// A square banded matrix.
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

}  // namespace gonogo::sim
