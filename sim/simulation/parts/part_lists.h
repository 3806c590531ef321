// Kernels of a part's step: numbers and places of its contacts, what others hold of its bodies, how far they moved.
#pragma once
#include <vector>

#include "sim/state/contact_lists.h"
#include "sim/state/state.h"

namespace gonogo::sim {

/// Runs a body of a loop for the indices from `first` on.
template <class Body>
struct FromIndex {
  Body body;
  Index first;
  GONOGO_HD void operator()(Index k) const { body(first + k); }
};

/// to[k] = from[body[k]]
template <class T>
struct PickItem {
  View<const Index> item;
  View<const T> from;
  View<T> to;
  GONOGO_HD void operator()(Index k) const { to[k] = from[item[k]]; }
};

/// to[body[k]] = from[k]
template <class T>
struct PutItem {
  View<const Index> item;
  View<const T> from;
  View<T> to;
  GONOGO_HD void operator()(Index k) const { to[item[k]] = from[k]; }
};

/// Contacts of a shared body that the part's own shapes found: where the body owns them, and where it is body b.
struct SharedContacts {
  ContactRange owned{0, 0};               // contacts
  ContactRange second{0, 0};              // into the list of second contacts
  Index first_second = 0, owned_end = 0;  // of all of its contacts here

  GONOGO_HD Index count() const { return owned.end - owned.begin + second.end - second.begin; }
};

/// Finds the part's own contacts, in item 0, and those of its moving shared bodies.
struct FindOwnContacts {
  Incidence in;
  View<const BodyIndex> shared;
  BodyIndex own_begin, own_end;
  View<SharedContacts> found;  // [1 + shared]

  GONOGO_HD void operator()(Index k) const {
    const ContactRange own{in.owned_begin(own_begin), in.owned_begin(own_end)};
    if (k == 0) {
      found[0].owned = own;
      return;
    }
    const BodyIndex b = shared[k - 1];
    SharedContacts& of = found[k];
    of.owned = {limited(in.owned_begin(b), own), limited(in.owned_end(b), own)};
    of.second = {place(b, own.begin), place(b, own.end)};
    of.first_second = in.first_second[b];
    of.owned_end = in.owned_end(b);
  }

  GONOGO_HD static ContactIndex limited(ContactIndex i, const ContactRange& own) {
    return i < own.begin ? own.begin : i > own.end ? own.end : i;
  }

  /// First place in the list of second contacts whose contact is not before `i`.
  GONOGO_HD Index place(BodyIndex b, ContactIndex i) const {
    Index low = in.first_second[b], high = in.first_second[b + 1];
    while (low < high) {
      const Index middle = (low + high) / 2;
      if (in.second[middle] < i)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }
};

/// Lanes that sum the weights of one shared body.
inline constexpr Index kWeightLanes = 32;

/// Sums the weights of a shared body's contacts that the part's own shapes found.
struct WeighShared {
  View<const SharedContacts> found;  // [1 + shared]
  View<const Contact> contact;
  View<const Impulse> start;
  View<const ContactIndex> second;
  View<Index> weight;  // [shared]

  GONOGO_HD void operator()(Index at) const {
    const Index k = at / kWeightLanes, lane = at % kWeightLanes;
    const SharedContacts& of = found[k + 1];
    Index sum = 0;
    for (ContactIndex i = of.owned.begin + lane; i < of.owned.end; i += kWeightLanes)
      sum += contact_weight(contact[i], start[i]);
    for (Index n = of.second.begin + lane; n < of.second.end; n += kWeightLanes)
      sum += contact_weight(contact[second[n]], start[second[n]]);
    if (sum > 0) atomic_add(weight[k], sum);
  }
};

/// Tiles of the contacts that earlier bodies found, of the own ones as the world cuts them, and of later ones.
struct PartTiles {
  ContactRange own{0, 0};
  Index head = 0, all = 0;  // own contacts that end a tile of the world; all contacts of the part
  View<Tile> tile;

  GONOGO_HD static Index tiles_of(Index contacts) { return (contacts + kTileSize - 1) / kTileSize; }
  GONOGO_HD Index first_own() const { return tiles_of(own.begin); }
  GONOGO_HD Index first_whole() const { return first_own() + (head > 0 ? 1 : 0); }
  GONOGO_HD Index first_later() const { return first_whole() + tiles_of(own.end - own.begin - head); }
  GONOGO_HD Index count() const { return first_later() + tiles_of(all - own.end); }

  GONOGO_HD void operator()(Index t) const {
    if (t < first_own()) return set(t, t * kTileSize, own.begin);
    if (t < first_whole()) return set(t, own.begin, own.begin + head);
    if (t < first_later()) return set(t, own.begin + head + (t - first_whole()) * kTileSize, own.end);
    set(t, own.end + (t - first_later()) * kTileSize, all);
  }

  GONOGO_HD void set(Index t, ContactIndex begin, ContactIndex end) const {
    GONOGO_ASSERT(begin < end);
    tile[t] = {{begin, begin + kTileSize < end ? begin + kTileSize : end}, 0, 0};
  }
};

// A tile of the world may lie across the border of two parts or more. Its contacts are then given one by one, so that
// sums over the world's tiles have the order and the bits of a world in one piece.

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

/// Numbers of a step's contacts: those of a part, and what it knows of the others.
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

/// Raises `moved` for a shape that has left the place for which the halo was found.
struct NoteMoved {
  View<const ShapeIndex> watched;
  View<const Vec3d> start;  // [watched]
  View<const Shape> shape;
  View<const Vec3d> position;
  View<const Quat> orientation;
  View<const WorldParameters> world;
  View<Index> moved;
  double margin;

  GONOGO_HD void operator()(Index k) const {
    const Shape& own = shape[watched[k]];
    const Vec3d centre = position[own.body] + static_cast<Vec3d>(rotate(orientation[own.body], own.offset_B));
    const Vec3d way = nearest_image(centre - start[k], world[0].period);
    if (!(dot(way, way) <= margin * margin)) atomic_raise(moved[0], 1);
  }
};

/// What a part tells the others at the end of a step, in one record.
struct StepEvents {
  Index flags = 0, slowed = 0, moved = 0;
};
struct CollectEvents {
  View<const Index> flags, slowed, moved;
  View<StepEvents> events;
  GONOGO_HD void operator()(Index) const { events[0] = {flags[0], slowed[0], moved[0]}; }
};

}  // namespace gonogo::sim
