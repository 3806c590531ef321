// The cells that a straight line crosses.
#pragma once
#include <cstdint>
#include <cstdlib>

namespace gonogo::map {

/// Walks from the centre of cell `from` to that of cell `to` on a grid of `columns`, after Amanatides and Woo (1987),
/// in whole numbers. Calls enter(cell, begin, end) for each cell with the share of the line inside of it [0, 1], and
/// corner(cell, cell) for the two cells beside a corner that the line passes through. Either may return false to stop.
/// Returns whether the end was reached.
template <class Enter, class Corner>
bool walk_line(int columns, std::uint32_t from, std::uint32_t to, Enter enter, Corner corner) {
  const int row_from = int(from) / columns, row_to = int(to) / columns;
  const int dx = int(to) % columns - int(from) % columns, dy = row_to - row_from;
  const std::int64_t across = std::abs(dx), down = std::abs(dy);
  const std::int64_t step_x = dx < 0 ? -1 : 1, step_y = dy < 0 ? -std::int64_t(columns) : columns;
  std::int64_t cell = from, i = 0, j = 0;  // crossings of columns and rows so far
  double begin = 0;
  while (i < across || j < down) {
    // The next crossings lie at (2 i + 1) / (2 across) and (2 j + 1) / (2 down) of the line.
    const std::int64_t x = i < across ? (2 * i + 1) * down : 0, y = j < down ? (2 * j + 1) * across : 0;
    const bool cross_x = j >= down || (i < across && x <= y), cross_y = i >= across || (j < down && y <= x);
    const double end = cross_x ? double(2 * i + 1) / double(2 * across) : double(2 * j + 1) / double(2 * down);
    if (!enter(std::uint32_t(cell), begin, end)) return false;
    if (cross_x && cross_y && !corner(std::uint32_t(cell + step_x), std::uint32_t(cell + step_y))) return false;
    cell += (cross_x ? step_x : 0) + (cross_y ? step_y : 0);
    i += cross_x;
    j += cross_y;
    begin = end;
  }
  return enter(std::uint32_t(cell), begin, 1.0);
}

}  // namespace gonogo::map
