// What a team does with one partition: factors, tips of the spikes, solutions. See spike.h for the symbols.
//
// Rows pass through a ring in the team's room. In step i of an elimination row i is final, and the `half` rows behind
// it take their share of it:
//
//   ring of rows   i .. i + half   in work;  behind them kTile free places, refilled every kTile steps
//   row            | left of the diagonal | diagonal | right of it | spike |      half + 1 + half + half numbers
//
// L is stored as it stands before division by the pivot: nobody writes what the others read, and a step has one
// barrier. In place of the pivot its reciprocal is stored.
#pragma once
#include <cmath>

#include "base/parallel/team.h"

namespace gonogo::sim {

/// Rows [first(p), first(p + 1)) are partition p.
struct Partitions {
  Index size = 0, half = 0, count = 0;

  GONOGO_HD Index first(Index p) const { return Index(std::int64_t(size) * p / count); }
  GONOGO_HD Index rows(Index p) const { return first(p + 1) - first(p); }
  GONOGO_HD Index stride() const { return 2 * half + 1; }
};

/// A pivot of at least this size.
template <class Scalar>
GONOGO_HD Scalar lifted(Scalar pivot, Scalar least) {
  if (std::fabs(pivot) >= least) return pivot;
  return pivot < 0 ? -least : least;
}

/// to += factor from.
template <class Team, class Scalar>
GONOGO_HD void add_scaled(Team team, Scalar* to, const Scalar* from, Scalar factor, Index count) {
  for (Index q = team.column(); q < count; q += team.columns()) to[q] = std::fma(factor, from[q], to[q]);
}

/// Rows that are loaded at once.
inline constexpr Index kTile = 8;

/// half + 1 + kTile rows, row i in place i % places.
template <class Scalar>
struct RowRing {
  Scalar* data;
  Index width, places;

  GONOGO_HD Scalar* at(Index place) const { return data + place * width; }
  GONOGO_HD Scalar* row(Index i) const { return at(i % places); }
  GONOGO_HD Index next(Index place, Index steps) const {
    const Index to = place + steps;
    return to < places ? to : to - places;
  }
  GONOGO_HD Index before(Index place, Index steps) const {
    const Index to = place - steps;
    return to >= 0 ? to : to + places;
  }
  static std::size_t bytes(Index half, Index width) { return sizeof(Scalar) * std::size_t((half + 1 + kTile) * width); }
};

/// Where the factors of a partition are kept. Upwards, those of its rows from the last to the first, of which only the
/// last `half` are kept: the corner.
template <class Scalar>
struct FactorRows {
  View<Scalar> value;  // [size][2 half + 1], or [partitions][half][2 half + 1] upwards
  bool is_up = false;

  /// Null where it is not kept.
  GONOGO_HD Scalar* row(const Partitions& all, Index p, Index i) const {
    if (!is_up) return value.data + std::int64_t(all.first(p) + i) * all.stride();
    const Index in_corner = i - (all.rows(p) - all.half);
    return in_corner < 0 ? nullptr : value.data + std::int64_t(p * all.half + in_corner) * all.stride();
  }
};

/// A_p = L U and, if asked for, L^-1 C_p.
template <class Scalar>
struct FactorisePartition {
  Partitions all;
  View<const double> a;  // [size][2 half + 1]
  FactorRows<Scalar> factor;
  View<Scalar> swept;   // L^-1 C_p: [size][half]; empty: not asked for
  View<Index> boosted;  // [1]
  Scalar least;

  TeamShape shape() const;
  template <class Team>
  GONOGO_HD void operator()(Team team, Index p, double* room) const {
    const Index k = all.half, rows = all.rows(p), spike = swept.size > 0 ? k : 0;
    const RowRing<Scalar> ring{room_of<Scalar>(room), 2 * k + 1 + spike, k + 1 + kTile};
    load(team, p, ring, 0, k + 1 < rows ? k + 1 : rows);
    team.sync();
    for (Index i = 0, place = 0; i < rows; ++i, place = ring.next(place, 1)) {
      if (i % kTile == 0) load(team, p, ring, i + k + 1, i + k + 1 + kTile);
      const Scalar* const pivot = ring.at(place);
      const Scalar inverse = 1 / lifted(pivot[k], least);
      if (team.rank() == 0 && lifted(pivot[k], least) != pivot[k]) atomic_increment(boosted[0]);
      store(team, p, i, pivot, inverse);
      for (Index r = 1 + team.row(); r <= k && i + r < rows; r += team.rows()) {
        Scalar* const row = ring.at(ring.next(place, r));
        const Scalar factor_of_row = -(row[k - r] * inverse);
        add_scaled(team, row + k + 1 - r, pivot + k + 1, factor_of_row, k);
        add_scaled(team, row + 2 * k + 1, pivot + 2 * k + 1, factor_of_row, spike);
      }
      team.sync();
    }
  }

 private:
  /// Rows [from, to) of the walk, as far as there are.
  template <class Team>
  GONOGO_HD void load(Team team, Index p, const RowRing<Scalar>& ring, Index from, Index to) const {
    const Index k = all.half, rows = all.rows(p);
    for (Index i = from + team.row(); i < to && i < rows; i += team.rows()) {
      const Index stored = all.first(p) + (factor.is_up ? rows - 1 - i : i);
      const double* const source = a.data + std::int64_t(stored) * all.stride();
      Scalar* const row = ring.row(i);
      for (Index q = team.column(); q <= 2 * k; q += team.columns())
        row[q] = Scalar(source[factor.is_up ? 2 * k - q : q]);
      for (Index c = team.column(); 2 * k + 1 + c < ring.width; c += team.columns())
        row[2 * k + 1 + c] = c >= i ? Scalar(source[c - i]) : Scalar(0);
    }
  }
  template <class Team>
  GONOGO_HD void store(Team team, Index p, Index i, const Scalar* row, Scalar inverse) const {
    const Index k = all.half;
    Scalar* const to = factor.row(all, p, i);
    if (to == nullptr) return;
    for (Index q = team.rank(); q <= 2 * k; q += team.size()) to[q] = q == k ? inverse : row[q];
    if (swept.size == 0) return;
    Scalar* const spike = swept.data + std::int64_t(all.first(p) + i) * k;
    for (Index c = team.rank(); c < k; c += team.size()) spike[c] = row[2 * k + 1 + c];
  }
};

/// The tips of a node of the tree: [half][2 half] at its top and the same at its bottom; V left, W right.
template <class Scalar>
struct Tips {
  Scalar *top, *bottom;
};
template <class Scalar>
GONOGO_HD Tips<Scalar> tips_of(View<Scalar> tips, Index half, Index node) {
  Scalar* const top = tips.data + std::int64_t(node) * 4 * half * half;
  return {top, top + 2 * half * half};
}

/// Tips from the factors, by a sweep backward: all four, or where `swept` is empty the bottom of V alone. Upwards that
/// is the top of W.
template <class Scalar>
struct FindTips {
  Partitions all;
  FactorRows<Scalar> factor;
  View<const Scalar> swept;
  View<Scalar> tips;

  TeamShape shape() const;
  template <class Team>
  GONOGO_HD void operator()(Team team, Index p, double* room) const {
    const Index k = all.half, rows = all.rows(p), columns = swept.size > 0 ? 2 * k : k;
    const Index last = swept.size > 0 ? 0 : rows - k;
    const RowRing<Scalar> ring{room_of<Scalar>(room), k + 1 + columns, k + 1 + kTile};
    load(team, p, ring, rows - k - 1 > last ? rows - k - 1 : last, rows);
    team.sync();
    for (Index i = rows - 1, step = 0, place = i % ring.places; i >= last; --i, ++step, place = ring.before(place, 1)) {
      const Index behind = i - k - kTile > last ? i - k - kTile : last;
      if (step % kTile == 0) load(team, p, ring, behind, i - k);
      const Scalar* const row = ring.at(place);
      keep(team, p, i, row);
      for (Index r = 1 + team.row(); r <= k && i - r >= last; r += team.rows()) {
        Scalar* const above = ring.at(ring.before(place, r));
        add_scaled(team, above + k + 1, row + k + 1, -(above[r] * row[0]), columns);
      }
      team.sync();
    }
  }

 private:
  /// Row i in the ring: reciprocal of the pivot, U, row of L^-1 (0, B), row of L^-1 C.
  template <class Team>
  GONOGO_HD void load(Team team, Index p, const RowRing<Scalar>& ring, Index from, Index to) const {
    const Index k = all.half, rows = all.rows(p);
    for (Index i = from + team.row(); i < to; i += team.rows()) {
      const Scalar* const source = factor.row(all, p, i) + k;
      Scalar* const row = ring.row(i);
      for (Index q = team.column(); q <= k; q += team.columns()) row[q] = source[q];
      for (Index c = team.column(); c < k; c += team.columns())
        row[k + 1 + c] = rows + c - i <= k ? source[rows + c - i] : Scalar(0);
      if (swept.size == 0) continue;
      const Scalar* const spike = swept.data + std::int64_t(all.first(p) + i) * k;
      for (Index c = team.column(); c < k; c += team.columns()) row[2 * k + 1 + c] = spike[c];
    }
  }
  template <class Team>
  GONOGO_HD void keep(Team team, Index p, Index i, const Scalar* row) const {
    const Index k = all.half, in_bottom = i - (all.rows(p) - k);
    const Tips<Scalar> to = tips_of(tips, k, p);
    if (factor.is_up) {
      for (Index c = team.rank(); c < k; c += team.size())
        to.top[(k - 1 - in_bottom) * 2 * k + k + (k - 1 - c)] = row[k + 1 + c] * row[0];
      return;
    }
    const Index columns = swept.size > 0 ? 2 * k : k;
    for (Index c = team.rank(); c < columns; c += team.size()) {
      if (in_bottom >= 0) to.bottom[in_bottom * 2 * k + c] = row[k + 1 + c] * row[0];
      if (i < k && columns > k) to.top[i * 2 * k + c] = row[k + 1 + c] * row[0];
    }
  }
};

/// x_p = A_p^-1 (f_p - C_p x_(p-1)^bottom - B_p x_(p+1)^top); without `outer` those are 0.
template <class Scalar>
struct SolvePartition {
  Partitions all;
  View<const double> a;
  View<Scalar> factor, right, outer;  // outer: [partitions][2 half], top of the next and bottom of the previous one
  View<Scalar> x;                     // [size]

  TeamShape shape() const;
  template <class Team>
  GONOGO_HD void operator()(Team team, Index p, double* room) const {
    const RowRing<Scalar> ring{room_of<Scalar>(room), all.half + 2, all.half + 1 + kTile};
    forward(team, p, ring);
    backward(team, p, ring);
  }

 private:
  template <class Team>
  GONOGO_HD void forward(Team team, Index p, const RowRing<Scalar>& ring) const {
    const Index k = all.half, rows = all.rows(p), first = all.first(p);
    load_lower(team, p, ring, 0, k + 1 < rows ? k + 1 : rows);
    team.sync();
    for (Index i = 0, place = 0; i < rows; ++i, place = ring.next(place, 1)) {
      if (i % kTile == 0) load_lower(team, p, ring, i + k + 1, i + k + 1 + kTile);
      const Scalar* const row = ring.at(place);
      const Scalar y = row[k + 1], scaled = -(y * row[k]);
      if (team.rank() == 0) x[first + i] = y;
      for (Index r = 1 + team.rank(); r <= k && i + r < rows; r += team.size()) {
        Scalar* const below = ring.at(ring.next(place, r));
        below[k + 1] = std::fma(below[k - r], scaled, below[k + 1]);
      }
      team.sync();
    }
  }
  template <class Team>
  GONOGO_HD void backward(Team team, Index p, const RowRing<Scalar>& ring) const {
    const Index k = all.half, rows = all.rows(p), first = all.first(p);
    load_upper(team, p, ring, rows - k - 1 > 0 ? rows - k - 1 : 0, rows);
    team.sync();
    for (Index i = rows - 1, step = 0, place = i % ring.places; i >= 0; --i, ++step, place = ring.before(place, 1)) {
      if (step % kTile == 0) load_upper(team, p, ring, i - k - kTile > 0 ? i - k - kTile : 0, i - k);
      const Scalar* const row = ring.at(place);
      const Scalar value = row[k + 1] * row[0];
      if (team.rank() == 0) x[first + i] = value;
      for (Index r = 1 + team.rank(); r <= k && r <= i; r += team.size()) {
        Scalar* const above = ring.at(ring.before(place, r));
        above[k + 1] = std::fma(-above[r], value, above[k + 1]);
      }
      team.sync();
    }
  }

  /// L, the reciprocal of the pivot, the right-hand side.
  template <class Team>
  GONOGO_HD void load_lower(Team team, Index p, const RowRing<Scalar>& ring, Index from, Index to) const {
    const Index k = all.half, rows = all.rows(p), first = all.first(p);
    for (Index i = from + team.row(); i < to && i < rows; i += team.rows()) {
      const Scalar* const source = factor.data + std::int64_t(first + i) * all.stride();
      Scalar* const row = ring.row(i);
      for (Index q = team.column(); q <= k; q += team.columns()) row[q] = source[q];
      if (team.column() == 0) row[k + 1] = right_side(p, i);
    }
  }
  /// The reciprocal of the pivot, U, what the sweep forward left.
  template <class Team>
  GONOGO_HD void load_upper(Team team, Index p, const RowRing<Scalar>& ring, Index from, Index to) const {
    const Index k = all.half, first = all.first(p);
    for (Index i = from + team.row(); i < to; i += team.rows()) {
      const Scalar* const source = factor.data + std::int64_t(first + i) * all.stride() + k;
      Scalar* const row = ring.row(i);
      for (Index q = team.column(); q <= k; q += team.columns()) row[q] = source[q];
      if (team.column() == 0) row[k + 1] = x[first + i];
    }
  }
  GONOGO_HD Scalar right_side(Index p, Index i) const {
    const Index k = all.half, rows = all.rows(p), first = all.first(p);
    Scalar value = right[first + i];
    if (outer.size == 0) return value;
    const double* const row = a.data + std::int64_t(first + i) * all.stride();
    const Scalar *const next = outer.data + std::int64_t(p) * 2 * k, *const previous = next + k;
    for (Index c = i; c < k; ++c) value = std::fma(-Scalar(row[c - i]), previous[c], value);
    for (Index c = 0; rows + c - i <= k; ++c) value = std::fma(-Scalar(row[k + rows + c - i]), next[c], value);
    return value;
  }
};

/// Members in rows as wide as `half` numbers, up to `most` of them, and at least `threads` where fewer rows would do.
inline TeamShape grid_for(Index half, Index most, std::size_t room) {
  TeamShape shape{.columns = 8, .rows = 1, .room = room};
  while (shape.columns < half && shape.columns < 32) shape.columns *= 2;
  while (shape.rows < half && 2 * shape.rows * shape.columns <= most) shape.rows *= 2;
  return shape;
}

template <class Scalar>
TeamShape FactorisePartition<Scalar>::shape() const {
  const Index k = all.half, width = swept.size > 0 ? 3 * k + 1 : 2 * k + 1;
  return grid_for(k, k > 32 ? kMostInTeam : kMostInTeam / 2, RowRing<Scalar>::bytes(k, width));
}
template <class Scalar>
TeamShape FindTips<Scalar>::shape() const {
  const Index k = all.half, width = swept.size > 0 ? 3 * k + 1 : 2 * k + 1;
  return grid_for(k, k > 32 ? kMostInTeam : kMostInTeam / 2, RowRing<Scalar>::bytes(k, width));
}
/// As many members as a step has rows.
template <class Scalar>
TeamShape SolvePartition<Scalar>::shape() const {
  const Index k = all.half;
  return grid_for(k, k > 32 ? 64 : 32, RowRing<Scalar>::bytes(k, k + 2));
}

}  // namespace gonogo::sim
