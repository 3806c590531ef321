// Numbers of a step's contacts: those of a part, and what it knows of the others.
#pragma once
#include "sim/simulation/parts/part_lists.h"
#include "sim/simulation/parts/tile_cut.h"

namespace gonogo::sim {

struct PartContacts {
  std::size_t me = 0;                     // the part
  ContactRange own{0, 0};                 // contacts that shapes of own bodies found
  std::vector<SharedContacts> shared;     // [moving shared body] among them
  std::vector<std::vector<Index>> count;  // [part] own contacts, then owned and second ones of each moving shared body
  std::vector<TileCut> cut;               // [part]
  std::int64_t before = 0, total = 0;     // of the world: before those of the part; all
  PartTiles tiles;

  Index owned_of(std::size_t part, std::size_t k) const { return count[part][2 * k + 1]; }
  Index second_of(std::size_t part, std::size_t k) const { return count[part][2 * k + 2]; }
  Index wrenches_of(std::size_t part) const {
    Index sum = 0;
    for (std::size_t n = 1; n < count[part].size(); ++n) sum += count[part][n];
    return sum;
  }

  Index head_tile() const { return cut[me].head > 0 ? tiles.first_own() : -1; }
  Index tail_tile() const { return cut[me].tail > 0 ? tiles.first_whole() + cut[me].whole : -1; }

  /// In: own, shared, and the counts of all parts.
  void place_own() {
    cut.clear();
    total = 0;
    for (std::size_t p = 0; p < count.size(); ++p) {
      if (p == me) before = total;
      cut.push_back(tile_cut(total, count[p][0]));
      total += count[p][0];
    }
  }
};

}  // namespace gonogo::sim
