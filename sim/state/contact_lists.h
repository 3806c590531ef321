// Lists of contacts by body, and tiles of contacts by world.
// Where a body is body a, its contacts are one contiguous run; where it is body b, a list names them. Both are read in
// ascending order, so sums have the same bits for any number of threads.
// Tiles are runs of contacts of one world, counted from the world's first contact. Sums over a world add its tiles in
// order, so they have the same bits in any batch and for any number of threads.
#pragma once
#include "sim/state/state.h"

namespace gonogo::sim {

/// Writes the lists, in any order.
struct FillSecond {
  View<const Contact> contact;
  View<const BodyMass> mass;
  View<const Index> first;
  View<Index> cursor;
  View<Index> item;
  GONOGO_HD void operator()(ContactIndex i) const {
    const BodyIndex b = contact[i].body_b;
    if (is_fixed(mass[b])) return;
    const Index at = first[b] + atomic_increment(cursor[b]);
    GONOGO_ASSERT(at < first[b + 1]);
    item[at] = i;
  }
};

/// Sorts the lists: each contact counts the smaller ones of the same body. One contact per thread, so that hundreds of
/// threads sort the hundreds of contacts of a wheel.
struct RankSecond {
  View<const Contact> contact;
  View<const BodyMass> mass;
  View<const Index> first, found;
  View<Index> sorted;
  View<Index> slot;  // [contact] position in the list, or -1
  GONOGO_HD void operator()(ContactIndex i) const {
    const BodyIndex b = contact[i].body_b;
    if (is_fixed(mass[b])) {
      slot[i] = -1;
      return;
    }
    Index rank = first[b];
    for (Index k = first[b]; k < first[b + 1]; ++k) rank += found[k] < i ? 1 : 0;
    GONOGO_ASSERT(rank < first[b + 1] && found[rank] >= 0);
    sorted[rank] = i;
    slot[i] = rank;
  }
};

/// Contacts of a body, in ascending order: those it owns, then those where it is body b and can move.
struct Incidence {
  View<const Index> first_shape, first_contact;  // body -> shapes -> contacts
  View<const Index> first_second, second;        // body -> contacts where it is body b

  GONOGO_HD Index owned_begin(BodyIndex b) const { return first_contact[first_shape[b]]; }
  GONOGO_HD Index owned_end(BodyIndex b) const { return first_contact[first_shape[b + 1]]; }
};

template <class Exec>
Incidence incidence(State<Exec>& s) {
  return {s.first_shape.view(), s.first_contact.view(), s.first_second.view(), s.second_contact.view()};
}

/// Call after find_contacts().
template <class Exec>
void build_incidence(Exec exec, State<Exec>& s) {
  GONOGO_ASSERT(s.second_found.size() == s.contact_capacity && s.second_contact.size() == s.contact_capacity);
  const Counted contacts = contact_count(s);
  exclusive_scan(exec, s.second_count.view(), s.first_second.view(), s.scratch);
  for_each_counted(exec, contacts,
                   FillSecond{s.contact.view(), s.mass.view(), s.first_second.view(), s.second_cursor.view(),
                              s.second_found.view()});
  for_each_counted(exec, contacts,
                   RankSecond{s.contact.view(), s.mass.view(), s.first_second.view(), s.second_found.view(),
                              s.second_contact.view(), s.second_slot.view()});
}

inline constexpr Index kTileSize = 256;

GONOGO_HD inline ContactRange contacts_of_world(const WorldParameters& world, View<const Index> first_contact) {
  GONOGO_ASSERT(first_contact[world.first_shape] <= first_contact[world.first_shape + world.shape_count]);
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
    GONOGO_ASSERT(begin >= r.begin && begin <= r.end);
    tile[t] = {{begin, begin + kTileSize < r.end ? begin + kTileSize : r.end}, low, first_tile[low] == t};
  }
};

/// Tiles of the present contacts and where those of each world start.
struct Tiles {
  View<const WorldParameters> world;
  View<const Index> first_contact, first_tile;
  View<const Tile> tile;

  GONOGO_HD Index count() const { return first_tile[first_tile.size - 1]; }
  GONOGO_HD ContactRange contacts(Index t) const {
    GONOGO_ASSERT(t < count());
    return tile[t].contacts;
  }
};

template <class Exec>
Tiles tiles(State<Exec>& s) {
  return {s.world.view(), s.first_contact.view(), s.first_tile.view(), s.tile.view()};
}

template <class Exec>
Index tile_capacity(const State<Exec>& s) {
  return s.contact_capacity / kTileSize + s.world_count + s.partial_tiles;
}

template <class Exec>
void cut_into_tiles(Exec exec, State<Exec>& s) {
  for_each_index(exec, s.world_count, CountTiles{s.world.view(), s.first_contact.view(), s.tiles_of_world.view()});
  exclusive_scan(exec, s.tiles_of_world.view(), s.first_tile.view(), s.tile_scratch);
  GONOGO_ASSERT(s.tile.size() == tile_capacity(s));
  for_each_index(exec, tile_capacity(s),
                 WriteTile{s.world.view(), s.first_contact.view(), s.first_tile.view(), s.tile.view()});
}

}  // namespace gonogo::sim
