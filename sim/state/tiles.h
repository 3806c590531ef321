// Tiles: runs of contacts of one world, counted from the world's first contact. Sums over a world add its tiles in
// order, so they have the same bits in any batch and for any number of threads.
#pragma once
#include "sim/state/state.h"

namespace gonogo::sim {

inline constexpr Index kTileSize = 256;

GONOGO_HD inline ContactRange contacts_of_world(const WorldParameters& world, View<const Index> first_contact) {
  return {first_contact[world.first_shape], first_contact[world.first_shape + world.shape_count]};
}

/// A world without contacts has one empty tile: its motors iterate too.
struct CountTiles {
  View<const WorldParameters> world;
  View<const Index> first_contact;
  View<Index> tiles_of_world;
  GONOGO_HD void operator()(WorldIndex w) const {
    const ContactRange r = contacts_of_world(world[w], first_contact);
    const Index tiles = (r.end - r.begin + kTileSize - 1) / kTileSize;
    tiles_of_world[w] = tiles > 0 ? tiles : 1;
  }
};

struct WriteTile {
  View<const WorldParameters> world;
  View<const Index> first_contact, first_tile;  // [shape + 1], [world + 1]
  View<Tile> tile;

  GONOGO_HD void operator()(Index t) const {
    Index low = 0, high = first_tile.size - 1;  // first_tile[low] <= t < first_tile[high]
    if (t >= first_tile[high]) return;
    while (high - low > 1) {
      const Index middle = (low + high) / 2;
      (first_tile[middle] <= t ? low : high) = middle;
    }
    const ContactRange r = contacts_of_world(world[low], first_contact);
    const ContactIndex begin = r.begin + (t - first_tile[low]) * kTileSize;
    tile[t] = {{begin, begin + kTileSize < r.end ? begin + kTileSize : r.end}, low, first_tile[low] == t};
  }
};

/// Tiles of the present contacts and where those of each world start.
struct Tiles {
  View<const WorldParameters> world;
  View<const Index> first_contact, first_tile;
  View<const Tile> tile;

  GONOGO_HD Index count() const { return first_tile[first_tile.size - 1]; }
  GONOGO_HD ContactRange contacts(Index t) const { return tile[t].contacts; }
};

template <class Exec>
Tiles tiles(State<Exec>& s) {
  return {s.world.view(), s.first_contact.view(), s.first_tile.view(), s.tile.view()};
}

template <class Exec>
Index tile_capacity(const State<Exec>& s) {
  return s.contact_capacity / kTileSize + s.world_count;
}

template <class Exec>
void cut_into_tiles(Exec exec, State<Exec>& s) {
  for_each_index(exec, s.world_count, CountTiles{s.world.view(), s.first_contact.view(), s.tiles_of_world.view()});
  exclusive_scan(exec, s.tiles_of_world.view(), s.first_tile.view(), s.tile_scratch);
  for_each_index(exec, tile_capacity(s),
                 WriteTile{s.world.view(), s.first_contact.view(), s.first_tile.view(), s.tile.view()});
}

}  // namespace gonogo::sim
