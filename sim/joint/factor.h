// Dense symmetric elimination of a mechanism's rows by a team of threads: [A | J | b] becomes [. | A^-1 J | A^-1 b].
// One pass down factors A = L D L^T and applies it to the right-hand sides, one pass goes up. Zeros between rows of
// bodies that are not connected cost nothing. Rows are scaled to A_ii = 1, so pivots lie between 0 and 1. A row that
// depends on rows before it (a planar four-bar has three such) has a pivot of rounding size; it is left out and gets no
// impulse.
#pragma once
#include "base/team.h"
#include "sim/state/mechanism.h"

namespace gonogo::sim {

/// Row-major [row_count x stride]; the first `first_right` columns hold the upper triangle of A.
struct LinearSystem {
  double* number;
  Index rows, stride, first_right;

  GONOGO_HD double* row(Index i) const { return number + std::size_t(i) * stride; }
};

GONOGO_HD_INLINED void subtract(double* __restrict target, const double* __restrict source, double share, Index first,
                                Index end) {
  for (Index c = first; c < end; ++c) target[c] -= share * source[c];
}

/// Columns that a team computes at once: a warp of the GPU.
inline constexpr Index kColumnsAtOnce = 32;

/// Row i -= share(i) * row k for the rows of a range, in the columns from `first_column` on.
template <class Team, class Share>
GONOGO_HD void subtract_row(const Team& team, const LinearSystem& s, Index k, Index first_row, Index end_row,
                            Index first_column, const Share& share) {
  if constexpr (Team::kWholeRows) {
    for (Index i = first_row + team.rank(); i < end_row; i += team.size())
      if (const double x = share(i); x != 0) subtract(s.row(i), s.row(k), x, first_column, s.stride);
  } else {
    // Neighbouring threads take neighbouring columns of one row, so a row whose share is zero, as most are, costs one
    // read.
    const Index side_by_side = team.size() < kColumnsAtOnce ? team.size() : kColumnsAtOnce;
    const Index group = team.rank() / side_by_side, groups = team.size() / side_by_side;
    if (group >= groups) return;
    const Index first = first_column + team.rank() % side_by_side;
    const double* __restrict source = s.row(k);
    for (Index i = first_row + group; i < end_row; i += groups) {
      const double x = share(i);
      if (x == 0) continue;
      double* __restrict target = s.row(i);
      for (Index c = first; c < s.stride; c += side_by_side) target[c] -= x * source[c];
    }
  }
}

/// Rows with smaller pivots are left out. A pivot is the square of the angle between a row and those before it [rad^2].
/// Axes meant to be parallel agree to about 1e-6; a link of a millionth of its neighbours' mass still counts.
inline constexpr double kRedundantPivot = 1e-10;

/// Removes row k from the system, so that its part of the solution is zero.
template <class Team>
GONOGO_HD void leave_out(const Team& team, const LinearSystem& s, Index k) {
  team.sync();  // all have seen the pivot
  for (Index c = s.first_right + team.rank(); c < s.stride; c += team.size()) s.row(k)[c] = 0;
  if (team.rank() == 0) s.row(k)[k] = 1;
}

/// After this, row k of the right-hand side holds d_k times the solution's, with the pivots d_k on the diagonal.
template <class Team>
GONOGO_HD void eliminate(const Team& team, const LinearSystem& s) {
  for (Index k = 0; k < s.rows; ++k) {
    const double* pivot_row = s.row(k);
    const double pivot = pivot_row[k], inverse = 1 / pivot;
    if (pivot <= kRedundantPivot)
      leave_out(team, s, k);
    else
      subtract_row(team, s, k, k + 1, s.rows, k + 1, [&](Index i) { return pivot_row[i] * inverse; });
    team.sync();
  }
  for (Index k = s.rows - 1; k > 0; --k) {
    const double inverse = 1 / s.row(k)[k];
    subtract_row(team, s, k, 0, k, s.first_right, [&](Index i) { return s.row(i)[k] * inverse; });
    team.sync();
  }
}

}  // namespace gonogo::sim
