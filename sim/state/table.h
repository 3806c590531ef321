// Piecewise-linear tables. All tables of a batch lie in one array; a table is a range of it.
#pragma once
#include "base/view.h"

namespace gonogo::sim {

struct TablePoint {
  double at = 0, value = 0;
};

/// Points first .. first + count - 1, ascending in `at`, at least one.
struct Table {
  Index first = 0, count = 0;
};

/// Linear between points; the outer values hold beyond the ends.
GONOGO_HD inline double interpolate(View<const TablePoint> points, const Table& table, double at) {
  Index low = table.first, high = table.first + table.count - 1;
  if (at <= points[low].at) return points[low].value;
  if (at >= points[high].at) return points[high].value;
  while (high - low > 1) {
    const Index middle = low + (high - low) / 2;
    (points[middle].at <= at ? low : high) = middle;
  }
  const TablePoint &a = points[low], &b = points[high];
  return a.value + (b.value - a.value) * ((at - a.at) / (b.at - a.at));
}

}  // namespace gonogo::sim
