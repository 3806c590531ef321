// Dense symmetric elimination of a mechanism's rows by a team. [A | J | b] becomes [. | A^-1 J | A^-1 b]: one pass down
// (A = L D L^T, applied to the right-hand sides at once) and one up. Rows of bodies that are not connected directly
// meet as zeros and cost nothing. No pivoting: A is positive definite thanks to its softness.
#pragma once
#include "base/team.h"
#include "sim/joint/mechanism.h"

namespace gonogo::sim {

/// Row-major [row_count x stride]; the first `first_right` columns hold the upper triangle of A.
struct LinearSystem {
  double* number;
  Index rows, stride, first_right;

  GONOGO_HD double* row(Index i) const { return number + std::size_t(i) * stride; }
};

/// target -= share * source over Lanes columns.
template <int kLanes>
GONOGO_HD_INLINED void subtract_row(double* __restrict target, const double* __restrict source, double share) {
  for (int lane = 0; lane < kLanes; ++lane) target[lane] -= share * source[lane];
}

/// After this, row k of the right-hand side holds d_k times the solution's, with the pivots d_k on the diagonal.
template <class Team>
GONOGO_HD void eliminate(const Team& team, const LinearSystem& s) {
  for (Index k = 0; k < s.rows; ++k) {
    const double* pivot_row = s.row(k);
    const double inverse = 1 / pivot_row[k];
    team.for_each_cell(k + 1, s.rows, (k + 1) / Team::kLanes * Team::kLanes, s.stride, [&](Index i, Index c) {
      const double share = pivot_row[i] * inverse;
      if (share != 0 && (c >= i / Team::kLanes * Team::kLanes))
        subtract_row<Team::kLanes>(s.row(i) + c, pivot_row + c, share);
    });
    team.sync();
  }
  for (Index k = s.rows - 1; k > 0; --k) {
    const double* solved_row = s.row(k);
    const double inverse = 1 / solved_row[k];
    team.for_each_cell(0, k, s.first_right, s.stride, [&](Index i, Index c) {
      const double share = s.row(i)[k] * inverse;
      if (share != 0) subtract_row<Team::kLanes>(s.row(i) + c, solved_row + c, share);
    });
    team.sync();
  }
}

}  // namespace gonogo::sim
