// A bed without end for a vehicle that moves along x: on a periodic bed, ground ahead that the vehicle has not reached
// and ground behind that it has left are the same place. There the grains are put back to where they were at the start,
// at rest: a virgin slab is swapped in ahead while one is dropped behind, and the cost does not grow with the distance.
#pragma once
#include "sim/simulation.h"

namespace gonogo::terrain {

struct MovingPatch {
  double length = 0;  // period of the bed [m]
  double reach =
      0;  // grains whose place at the start is within this distance along x of the vehicle are left alone [m]
};

/// Throws InputError for a bed so short that no slab is left to swap.
void check_patch(const MovingPatch& patch, double grain_diameter);

/// Grains, by their places at the start, that a vehicle at `x` leaves or has not reached.
std::vector<sim::BodyIndex> virgin_grains(const MovingPatch& patch, const std::vector<Vec3d>& start, double x);

/// Puts them back. Bodies 0 .. start.size() - 1 of the world are the grains. Depends on the vehicle's place alone: the
/// same call again changes nothing.
void renew_ground(sim::Simulation& simulation, sim::WorldIndex world, const MovingPatch& patch,
                  const std::vector<Vec3d>& start, double x);

}  // namespace gonogo::terrain
