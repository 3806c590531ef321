// Two neighbouring partitions as one, and what that makes of right-hand sides.
//
//   left    x_top + V_top s + W_top p = g_top          s: top of the right one      p: bottom of what is before both
//           r     + V_bot s + W_bot p = g_bot          r: bottom of the left one    n: top of what is behind both
//   right   s     + V_top n + W_top r = g_top
//           x_bot + V_bot n + W_bot r = g_bot
//
// Between them, with (n, p) as the outer unknowns:
//   s = h + N (n, p)          S = I - W_top^R V_bot^L,  h = S^-1 (g_top^R - W_top^R g_bot^L)
//                             N = S^-1 (-V_top^R, W_top^R W_bot^L)
//   r = e - E (n, p)          e = g_bot^L - V_bot^L h,  E = (0, W_bot^L) + V_bot^L N
// and the pair has the tips
//   top      (0, W_top^L) + V_top^L N,   g_top^L - V_top^L h
//   bottom   (V_bot^R, 0) - W_bot^R E,   g_bot^R - W_bot^R e
#pragma once
#include "sim/local_problem/banded/team_partition.h"

namespace gonogo::sim {

/// Nodes first, first + 1, ... of one level of the tree, and their parents. Truncated SPIKE joins each node with the
/// next.
struct PairsOfNodes {
  Index first = 0, nodes = 0, parent = 0;
  Index joint = 0;  // of the first pair
  bool is_tree = true;

  GONOGO_HD Index count() const { return is_tree ? (nodes + 1) / 2 : nodes - 1; }
  GONOGO_HD Index left(Index pair) const { return first + (is_tree ? 2 * pair : pair); }
  /// The last node of an odd number has no partner and is its own parent's only child.
  GONOGO_HD bool is_alone(Index pair) const { return left(pair) + 1 == first + nodes; }
};

/// c = start + sign a b; start null: 0. c and start: [rows][columns], a: [rows][inner], b: [inner][columns].
template <class Scalar>
struct Product {
  Scalar* c;
  Index c_step;
  const Scalar* start;
  Index start_step;
  Scalar sign;
  const Scalar* a;
  Index a_step;
  const Scalar* b;
  Index b_step;
  Index rows, inner, columns;

  /// Four rows at a time, so that a number of b is loaded once for four.
  template <class Team>
  GONOGO_HD void run(Team team) const {
    constexpr Index kRows = 4;
    for (Index i = kRows * team.row(); i < rows; i += kRows * team.rows()) {
      const Index count = rows - i < kRows ? rows - i : kRows;
      for (Index j = team.column(); j < columns; j += team.columns()) {
        Scalar sum[kRows] = {};
        for (Index r = 0; r < kRows; ++r)
          if (start != nullptr && r < count) sum[r] = start[(i + r) * start_step + j];
        for (Index q = 0; q < inner; ++q) {
          const Scalar factor = sign * b[q * b_step + j];
          for (Index r = 0; r < kRows; ++r)
            if (r < count) sum[r] = std::fma(a[(i + r) * a_step + q], factor, sum[r]);
        }
        for (Index r = 0; r < kRows; ++r)
          if (r < count) c[(i + r) * c_step + j] = sum[r];
      }
    }
  }
};

/// Inverts s [n][n] in place by Gauss and Jordan with exchange of rows. pivot: [n]. Returns how many pivots were
/// lifted.
template <class Team, class Scalar>
GONOGO_HD Index invert(Team team, Scalar* s, Index n, Index* pivot, Scalar least) {
  Index boosted = 0;
  for (Index p = 0; p < n; ++p) {
    Index best = p;
    for (Index i = p + 1; i < n; ++i)
      if (std::fabs(s[i * n + p]) > std::fabs(s[best * n + p])) best = i;
    team.sync();
    if (team.rank() == 0) pivot[p] = best;
    for (Index j = team.rank(); best != p && j < n; j += team.size()) {
      const Scalar kept = s[p * n + j];
      s[p * n + j] = s[best * n + j];
      s[best * n + j] = kept;
    }
    team.sync();
    const Scalar value = lifted(s[p * n + p], least), inverse = 1 / value;
    if (value != s[p * n + p]) ++boosted;
    for (Index i = team.row(); i < n; i += team.rows()) {
      const Scalar factor = -(s[i * n + p] * inverse);
      for (Index j = team.column(); i != p && j < n; j += team.columns())
        if (j != p) s[i * n + j] = std::fma(factor, s[p * n + j], s[i * n + j]);
    }
    team.sync();
    for (Index i = team.rank(); i < n; i += team.size()) {
      if (i != p) s[i * n + p] *= -inverse;
      if (i != p) s[p * n + i] *= inverse;
    }
    if (team.rank() == 0) s[p * n + p] = inverse;
    team.sync();
  }
  for (Index i = team.rank(); i < n; i += team.size())  // columns return in the other order
    for (Index p = n - 1; p >= 0; --p) {
      const Scalar kept = s[i * n + p];
      s[i * n + p] = s[i * n + pivot[p]];
      s[i * n + pivot[p]] = kept;
    }
  team.sync();
  return boosted;
}

/// What joints keep: S^-1 [half][half] and, in a tree, N [half][2 half] of each.
template <class Scalar>
struct Joints {
  View<Scalar> inverse, response;

  GONOGO_HD Scalar* inverse_of(Index half, Index joint) const {
    return inverse.data + std::int64_t(joint) * half * half;
  }
  GONOGO_HD Scalar* response_of(Index half, Index joint) const {
    return response.data + std::int64_t(joint) * 2 * half * half;
  }
};

/// S^-1 of each pair and, in a tree, N and the parent's tips.
template <class Scalar>
struct JoinPair {
  Index half;
  PairsOfNodes pairs;
  View<Scalar> tips;
  Joints<Scalar> joints;
  View<Index> boosted;
  Scalar least;

  TeamShape shape() const {
    const std::size_t k = std::size_t(half);
    return grid_for(half, kMostInTeam, 3 * k * k * sizeof(Scalar) + k * sizeof(Index));
  }
  template <class Team>
  GONOGO_HD void operator()(Team team, Index pair, double* room) const {
    const Index k = half, left = pairs.left(pair);
    const Tips<Scalar> l = tips_of(tips, k, left), up = tips_of(tips, k, pairs.parent + pair);
    if (pairs.is_alone(pair)) {
      for (Index q = team.rank(); q < 4 * k * k; q += team.size()) up.top[q] = l.top[q];
      return;
    }
    const Tips<Scalar> r = tips_of(tips, k, left + 1);
    Scalar *const s = room_of<Scalar>(room), *const e = s + k * k;
    for (Index i = team.row(); i < k; i += team.rows())
      for (Index j = team.column(); j < k; j += team.columns()) e[i * k + j] = i == j ? Scalar(1) : Scalar(0);
    team.sync();
    multiply(team, s, k, e, k, -1, r.top + k, 2 * k, l.bottom, 2 * k, k);
    team.sync();
    const Index lifts = invert(team, s, k, reinterpret_cast<Index*>(e + 2 * k * k), least);
    if (team.rank() == 0 && lifts > 0) atomic_add(boosted[0], lifts);
    for (Index q = team.rank(); q < k * k; q += team.size()) joints.inverse_of(k, pairs.joint + pair)[q] = s[q];
    if (pairs.is_tree) grow(team, l, r, up, joints.response_of(k, pairs.joint + pair), s, e);
  }

 private:
  /// c = start + sign a b of `half` rows and as many inner ones.
  template <class Team>
  GONOGO_HD void multiply(Team team, Scalar* c, Index c_step, const Scalar* start, Index start_step, Scalar sign,
                          const Scalar* a, Index a_step, const Scalar* b, Index b_step, Index columns) const {
    Product<Scalar>{c, c_step, start, start_step, sign, a, a_step, b, b_step, half, half, columns}.run(team);
  }

  template <class Team>
  GONOGO_HD void grow(Team team, const Tips<Scalar>& l, const Tips<Scalar>& r, const Tips<Scalar>& up, Scalar* n,
                      const Scalar* s, Scalar* e) const {
    const Index k = half, w = 2 * k;
    multiply(team, e, w, nullptr, 0, -1, s, k, r.top, w, k);         // -S^-1 V_top^R
    multiply(team, e + k, w, nullptr, 0, 1, s, k, r.top + k, w, k);  // S^-1 W_top^R
    team.sync();
    for (Index i = team.row(); i < k; i += team.rows())
      for (Index j = team.column(); j < k; j += team.columns()) n[i * w + j] = e[i * w + j];
    multiply(team, n + k, w, nullptr, 0, 1, e + k, w, l.bottom + k, w, k);
    team.sync();
    multiply(team, e, w, nullptr, 0, 1, l.bottom, w, n, w, k);
    multiply(team, e + k, w, l.bottom + k, w, 1, l.bottom, w, n + k, w, k);
    multiply(team, up.top, w, nullptr, 0, 1, l.top, w, n, w, k);
    multiply(team, up.top + k, w, l.top + k, w, 1, l.top, w, n + k, w, k);
    team.sync();
    multiply(team, up.bottom, w, r.bottom, w, -1, r.bottom + k, w, e, w, k);
    multiply(team, up.bottom + k, w, nullptr, 0, -1, r.bottom + k, w, e + k, w, k);
  }
};

/// start + sign a_row x.
template <class Scalar>
GONOGO_HD Scalar row_product(Scalar start, Scalar sign, const Scalar* row, const Scalar* x, Index count) {
  for (Index q = 0; q < count; ++q) start = std::fma(row[q], sign * x[q], start);
  return start;
}

/// Right-hand sides up the tree: h and e of each pair, g of its parent. Without a tree h and e are the answer.
template <class Scalar>
struct JoinEnds {
  Index half;
  PairsOfNodes pairs;
  View<Scalar> tips;
  Joints<Scalar> joints;
  View<Scalar> ends;    // [nodes][2 half]: g at the top, at the bottom
  View<Scalar> middle;  // [joints][2 half]: h, e
  View<Scalar> outer;   // [nodes][2 half]: n, p

  TeamShape shape() const { return grid_for(half, half > 32 ? 64 : 32, 2 * std::size_t(half) * sizeof(Scalar)); }
  template <class Team>
  GONOGO_HD void operator()(Team team, Index pair, double* room) const {
    const Index k = half, w = 2 * k, left = pairs.left(pair);
    const Scalar *const gl = ends.data + std::int64_t(left) * w, *const gr = gl + w;
    Scalar* const up = ends.data + std::int64_t(pairs.parent + pair) * w;
    if (pairs.is_alone(pair)) {
      for (Index q = team.rank(); q < w; q += team.size()) up[q] = gl[q];
      return;
    }
    const Tips<Scalar> l = tips_of(tips, k, left), r = tips_of(tips, k, left + 1);
    const Scalar* const inverse = joints.inverse_of(k, pairs.joint + pair);
    Scalar *const rest = room_of<Scalar>(room), *const h = middle.data + std::int64_t(pairs.joint + pair) * w;
    for (Index i = team.rank(); i < k; i += team.size())
      rest[i] = row_product(gr[i], Scalar(-1), r.top + i * w + k, gl + k, k);
    team.sync();
    for (Index i = team.rank(); i < k; i += team.size())
      h[i] = row_product(Scalar(0), Scalar(1), inverse + i * k, rest, k);
    team.sync();
    for (Index i = team.rank(); i < k; i += team.size()) {
      h[k + i] = row_product(gl[k + i], Scalar(-1), l.bottom + i * w, h, k);
      if (pairs.is_tree) up[i] = row_product(gl[i], Scalar(-1), l.top + i * w, h, k);
    }
    team.sync();
    for (Index i = team.rank(); i < k; i += team.size()) {
      if (pairs.is_tree) {
        up[k + i] = row_product(gr[k + i], Scalar(-1), r.bottom + i * w + k, h + k, k);
      } else {
        outer[left * w + i] = h[i];
        outer[(left + 1) * w + k + i] = h[k + i];
      }
    }
  }
};

/// Outer unknowns down the tree: those of two children from those of their parent.
template <class Scalar>
struct SplitOuter {
  Index half;
  PairsOfNodes pairs;
  View<Scalar> tips;
  Joints<Scalar> joints;
  View<Scalar> middle, outer;

  TeamShape shape() const { return grid_for(half, half > 32 ? 64 : 32, std::size_t(half) * sizeof(Scalar)); }
  template <class Team>
  GONOGO_HD void operator()(Team team, Index pair, double* room) const {
    const Index k = half, w = 2 * k, left = pairs.left(pair);
    const Scalar* const np = outer.data + std::int64_t(pairs.parent + pair) * w;
    Scalar *const to_left = outer.data + std::int64_t(left) * w, *const to_right = to_left + w;
    if (pairs.is_alone(pair)) {
      for (Index q = team.rank(); q < w; q += team.size()) to_left[q] = np[q];
      return;
    }
    const Scalar* const bottom = tips_of(tips, k, left).bottom;
    const Scalar *const n = joints.response_of(k, pairs.joint + pair), *const h = middle.data +
                                                                                  std::int64_t(pairs.joint + pair) * w;
    Scalar* const more = room_of<Scalar>(room);  // N (n, p)
    for (Index i = team.rank(); i < k; i += team.size()) {
      more[i] = row_product(Scalar(0), Scalar(1), n + i * w, np, w);
      to_left[i] = h[i] + more[i];
      to_left[k + i] = np[k + i];
      to_right[i] = np[i];
    }
    team.sync();
    for (Index i = team.rank(); i < k; i += team.size()) {
      const Scalar by_p = row_product(h[k + i], Scalar(-1), bottom + i * w + k, np + k, k);
      to_right[k + i] = row_product(by_p, Scalar(-1), bottom + i * w, more, k);
    }
  }
};

/// g of a partition: top and bottom of A_p^-1 f_p.
template <class Scalar>
struct TakeEnds {
  Partitions all;
  View<const Scalar> x;
  View<Scalar> ends;

  GONOGO_HD void operator()(Index place) const {
    const Index k = all.half, p = place / (2 * k), q = place % (2 * k);
    ends[place] = q < k ? x[all.first(p) + q] : x[all.first(p + 1) - 2 * k + q];
  }
};

}  // namespace gonogo::sim
