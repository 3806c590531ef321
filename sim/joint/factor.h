// Dense symmetric elimination of a mechanism's rows by a team. [A | J | b] becomes [. | A^-1 J | A^-1 b]: one pass down
// (A = L D L^T, applied to the right-hand sides at once) and one up. Rows of bodies that are not connected directly
// meet as zeros and cost nothing. Rows are scaled to A_ii = 1, so pivots are between 0 and 1; a row that repeats rows
// before it (a planar four-bar has three such) has a pivot of rounding size and is left out: it gets no impulse.
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

/// Square of the smallest angle between a row and those before it [rad^2]. Axes that should be parallel are so to about
/// 1e-6; a link of a millionth of its neighbours' mass still counts.
inline constexpr double kRedundantPivot = 1e-10;

/// Takes row k out of the system: its part of the solution becomes zero.
template <class Team>
GONOGO_HD void leave_out(const Team& team, const LinearSystem& s, Index k) {
  team.sync();  // all have seen the pivot
  for (Index c = s.first_right + team.rank(); c < s.stride; c += team.size()) s.row(k)[c] = 0;
  if (team.rank() == 0) s.row(k)[k] = 1;
}

/// After this, row k of the right-hand side holds d_k times the solution's, with the pivots d_k on the diagonal.
template <class Team>
GONOGO_HD void eliminate(const Team& team, const LinearSystem& s) {
  constexpr int kLanes = Team::kLanes;
  for (Index k = 0; k < s.rows; ++k) {
    const double* pivot_row = s.row(k);
    const double pivot = pivot_row[k], inverse = 1 / pivot;
    if (pivot <= kRedundantPivot)
      leave_out(team, s, k);
    else
      team.for_each_cell(k + 1, s.rows, (k + 1) / kLanes * kLanes, s.stride, [&](Index i, Index c) {
        const double share = pivot_row[i] * inverse;
        const bool needed = c >= i / kLanes * kLanes;  // the lower triangle is not
        if (share != 0 && needed) subtract_row<kLanes>(s.row(i) + c, pivot_row + c, share);
      });
    team.sync();
  }
  for (Index k = s.rows - 1; k > 0; --k) {
    const double* solved_row = s.row(k);
    const double inverse = 1 / solved_row[k];
    team.for_each_cell(0, k, s.first_right, s.stride, [&](Index i, Index c) {
      const double share = s.row(i)[k] * inverse;
      if (share != 0) subtract_row<kLanes>(s.row(i) + c, solved_row + c, share);
    });
    team.sync();
  }
}

}  // namespace gonogo::sim
