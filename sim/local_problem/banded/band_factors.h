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
#pragma once
#include <Eigen/Core>

namespace gonogo::sim {

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
