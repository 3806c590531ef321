// Sums over the tiles of a world whose contacts lie in several parts. A tile may lie across the border of two parts or
// more. Its contacts are then given one by one, so that the sums have the order and the bits of a world in one piece.
#pragma once
#include <vector>

#include "sim/state/contact_lists.h"

namespace gonogo::sim {

/// The contacts of a part: some that end a tile, whole tiles, and some that begin one.
struct TileCut {
  Index head = 0, whole = 0, tail = 0;

  Index tiles() const { return (head > 0 ? 1 : 0) + whole + (tail > 0 ? 1 : 0); }
  /// Numbers that the part gives: one for each contact of a partial tile, one for each whole tile.
  Index entries() const { return head + whole + tail; }
};

/// `before`: number of the world's contacts before those of the part.
inline TileCut tile_cut(std::int64_t before, Index count) {
  GONOGO_ASSERT(before >= 0 && count >= 0);
  TileCut cut;
  cut.head = std::min(count, Index((kTileSize - before % kTileSize) % kTileSize));
  cut.whole = (count - cut.head) / kTileSize;
  cut.tail = (count - cut.head) % kTileSize;
  return cut;
}

/// Adds what all parts give. `of_tile`: the sums of a tile from those of its contacts.
template <class Sums, class OfTile, class Add>
Sums sum_of_parts(const std::vector<TileCut>& cut, const std::vector<std::vector<Sums>>& given, const OfTile& of_tile,
                  const Add& add) {
  Sums total;
  std::vector<Sums> partial;
  const auto end_tile = [&] {
    if (!partial.empty()) add(total, of_tile(partial));
    partial.clear();
  };
  for (std::size_t p = 0; p < cut.size(); ++p) {
    GONOGO_ASSERT(Index(given[p].size()) == cut[p].entries());
    const Sums* next = given[p].data();
    const auto take_contacts = [&](Index count) {
      partial.insert(partial.end(), next, next + count);
      next += count;
      if (Index(partial.size()) == kTileSize) end_tile();
    };
    take_contacts(cut[p].head);
    for (Index t = 0; t < cut[p].whole; ++t) add(total, *next++);
    take_contacts(cut[p].tail);
  }
  end_tile();
  return total;
}

}  // namespace gonogo::sim
