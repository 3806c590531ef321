// Banded matrices, and their factors without exchange of rows.
#pragma once
#include <Eigen/Core>
#include <Eigen/Dense>
#include <cmath>
#include <cstring>
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

// Numbers side by side in one vector register of 32 bytes.

#ifdef __FMA__
#include <immintrin.h>
#endif

namespace gonogo::sim {

template <class Scalar>
struct Lanes {
  static constexpr Eigen::Index kWidth = 32 / Eigen::Index(sizeof(Scalar));
  typedef Scalar Pack __attribute__((vector_size(32)));

  static Pack load(const Scalar* from) {
    Pack p;
    std::memcpy(&p, from, sizeof p);
    return p;
  }
  static void store(Scalar* to, Pack p) { std::memcpy(to, &p, sizeof p); }
  static Pack fill(Scalar x) { return Pack{} + x; }

  /// a b + c, rounded once where the processor fuses them.
  static Pack multiply_add(Pack a, Pack b, Pack c) {
#ifdef __FMA__
    if constexpr (sizeof(Scalar) == 8)
      return _mm256_fmadd_pd(a, b, c);
    else
      return _mm256_fmadd_ps(a, b, c);
#else
    return a * b + c;
#endif
  }

  /// By halves.
  static Scalar sum(Pack p) {
    Scalar part[kWidth];
    store(part, p);
    for (Eigen::Index half = kWidth / 2; half > 0; half /= 2)
      for (Eigen::Index k = 0; k < half; ++k) part[k] += part[k + half];
    return part[0];
  }
};

}  // namespace gonogo::sim

namespace gonogo::sim {

// Factors of a banded matrix without exchange of rows: for matrices that are diagonally dominant or positive definite.
//
// A walk goes through the rows from the first to the last (direction 1) or from the last to the first (-1). In the
// order of the walk the factors are L U, L with a unit diagonal; those of a walk up are the U L of the matrix. They
// stand in the matrix's place, with reciprocals of the pivots on the diagonal.
//
// Factors are made by panels of four columns. In the order of the walk:
//
//     four columns  half columns
//     D  D  D  D    U  U  U  .  .  .      D, L, U: finished with the panel
//     D  D  D  D    U  U  U  U  .  .      C: C -= L U, four fused multiply-adds on each number that is loaded once
//     L  L  L  L    C  C  C  C  C  C
//     .  L  L  L    C  C  C  C  C  C  C

/// Entries (i, j), |i - j| <= half, in the order of the walk. The walk does not own them.
template <class Scalar, int Direction>
struct BandWalk {
  Scalar* origin = nullptr;  // entry (0, 0)
  Eigen::Index size = 0, half = 0;

  Scalar& at(Eigen::Index i, Eigen::Index j) const { return origin[Direction * (i * 2 * half + j)]; }
  /// The last `count` rows and columns.
  BandWalk tail(Eigen::Index count) const {
    const Eigen::Index left = size - count;
    return {origin + Direction * left * (2 * half + 1), count, half};
  }
};

/// Rows of a BandedMatrix, which hold 0 outside of the square block that they are.
template <class Scalar>
BandWalk<Scalar, 1> walk_down(Scalar* rows, Eigen::Index size, Eigen::Index half) {
  return {rows + half, size, half};
}
template <class Scalar>
BandWalk<Scalar, -1> walk_up(Scalar* rows, Eigen::Index size, Eigen::Index half) {
  return {rows + (size - 1) * (2 * half + 1) + half, size, half};
}

/// The factors in place. A pivot below `least` > 0 is set to +-least (as PARDISO does). Returns how many were.
template <class Scalar, int Direction>
int factorise_band(const BandWalk<Scalar, Direction>& a, Scalar least);

/// L x = b in place. x points to the walk's first entry and has its direction.
template <class Scalar, int Direction>
void sweep_forward(const BandWalk<const Scalar, Direction>& lu, Scalar* x);

/// U x = b in place.
template <class Scalar, int Direction>
void sweep_backward(const BandWalk<const Scalar, Direction>& lu, Scalar* x);

/// L X = B in place; X [size][columns], its rows in the order of the walk. Rows before `first` of B must be 0.
template <class Scalar, int Direction>
void sweep_rows_forward(const BandWalk<const Scalar, Direction>& lu, Scalar* x, Eigen::Index columns,
                        Eigen::Index first);

/// U X = B in place.
template <class Scalar, int Direction>
void sweep_rows_backward(const BandWalk<const Scalar, Direction>& lu, Scalar* x, Eigen::Index columns);

}  // namespace gonogo::sim
