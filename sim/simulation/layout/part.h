// A world in parts, one for each rank. The engine's order of bodies follows a space-filling curve, and a part owns a
// run of it. So the contacts that its bodies' shapes found are a run of the world's contacts, and what the parts list
// one after the other is in the order of a world in one piece. Beside its own bodies a part holds copies of others:
//   shared   bodies of mechanisms and elements, and those with large shapes: every part holds them
//   halo     bodies that may touch its own before any body has moved by half a bin
// It computes every contact of its own bodies. Host only.
#pragma once
#include <cstdint>
#include <vector>

#include "sim/scene/flat_world.h"
#include "sim/state/state.h"

namespace gonogo::sim {

inline constexpr int kMaxParts = 64;
inline constexpr int kMaxGpus = 8;  // parts on GPUs

/// Bodies by their index in the part, which keeps the order of the world.
struct Part {
  std::vector<BodyIndex> body;                         // [body] in the world, ascending
  std::vector<std::uint8_t> strangeness;               // [body]
  std::vector<std::uint8_t> is_shared;                 // [body]
  BodyIndex own_begin = 0, own_end = 0;                // its own bodies
  std::vector<BodyIndex> moving_shared;                // those that impulses can move
  std::vector<std::vector<BodyIndex>> sent, received;  // [rank] own bodies that it holds, copies of its bodies

  BodyIndex own_count() const { return own_end - own_begin; }
};

/// Whether the method's iteration can be divided.
bool can_be_divided(const StepSettings& settings);

/// The state in which a world enters.
Snapshot start_of(const FlatWorld& world);

/// First body of each part, and the number of bodies: [parts + 1]. Parts have about the same number of contacts and
/// bodies. `at`: present contacts; borders lie between runs of kTileSize bodies.
std::vector<BodyIndex> borders(const FlatWorld& world, const Snapshot& at, int parts);

/// Part `number` of a world at these positions.
Part part_of(const FlatWorld& world, const Snapshot& at, const std::vector<BodyIndex>& border, int number);

/// The bodies of a part as a world of their own, with all mechanisms and elements.
FlatWorld restricted(const FlatWorld& world, const Part& part);

/// Their state. `to`: the part as restricted() gives it.
Snapshot restricted(const Snapshot& snapshot, const FlatWorld& world, const Part& part, const FlatWorld& to);

/// Distance that shapes may move before a halo must be found anew [m].
double halo_margin(const WorldParameters& world);

/// Shape of the part -> shape of the world.
std::vector<ShapeIndex> shapes_in_world(const FlatWorld& world, const Part& part);

}  // namespace gonogo::sim
