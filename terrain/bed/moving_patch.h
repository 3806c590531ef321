// A bed without end for a vehicle that moves along x: on a periodic bed, ground ahead that the vehicle has not reached
// and ground behind that it has left are the same place. There the grains are put back to where they were at the start,
// at rest: a virgin slab is swapped in ahead while one is dropped behind, and the cost does not grow with the distance.
#pragma once
#include "sim/simulation/simulation.h"
#include "terrain/bed/clump.h"

namespace gonogo::terrain {

struct MovingPatch {
  double length = 0;  // period of the bed [m]
  double reach =
      0;  // grains whose place at the start is within this distance along x of the vehicle are left alone [m]
};

/// Throws InputError for a bed so short that no slab is left to swap.
void check_patch(const MovingPatch& patch, double grain_diameter);

/// Where a grain was at the start.
struct GrainPlace {
  Vec3d position;         // [m]
  Quat orientation = {};  // of clumps
};

/// Where the first `count` bodies of a world of grains of this shape are now.
std::vector<GrainPlace> grain_places(const std::vector<sim::BodyState>& bodies, GrainShape shape, std::size_t count);

/// Grains, by their places at the start, that a vehicle at `x` leaves or has not reached.
std::vector<sim::BodyIndex> virgin_grains(const MovingPatch& patch, const std::vector<GrainPlace>& start, double x);

/// Puts them back. Bodies 0 .. start.size() - 1 of the world are the grains. Depends on the vehicle's place alone: the
/// same call again changes nothing.
void renew_ground(sim::Simulation& simulation, sim::WorldIndex world, const MovingPatch& patch,
                  const std::vector<GrainPlace>& start, double x);

}  // namespace gonogo::terrain
