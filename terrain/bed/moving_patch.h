// An endless bed for a vehicle that moves along x. On a periodic bed, the ground far ahead of the vehicle and the
// ground far behind it are the same place. The grains there are put back to their positions at the start, at rest. The
// vehicle always meets undisturbed ground, and the cost does not grow with the distance.
#pragma once
#include "sim/simulation/simulation.h"
#include "terrain/bed/clump.h"

namespace gonogo::terrain {

struct MovingPatch {
  double length = 0;  // period of the bed [m]
  double reach = 0;   // grains that started within this distance of the vehicle along x are left alone [m]
};

/// Throws InputError for a bed so short that no slab is left to renew.
void check_patch(const MovingPatch& patch, double grain_diameter);

/// Pose of a grain at the start.
struct GrainPlace {
  Vec3d position;         // [m]
  Quat orientation = {};  // of clumps
};

/// Present poses of the first `count` bodies, which are grains of this shape.
std::vector<GrainPlace> grain_places(const std::vector<sim::BodyState>& bodies, GrainShape shape, std::size_t count);

/// Grains that started beyond the reach of a vehicle at `x`.
std::vector<sim::BodyIndex> virgin_grains(const MovingPatch& patch, const std::vector<GrainPlace>& start, double x);

/// Puts the virgin grains back. Bodies 0 .. start.size() - 1 of the world are the grains. The result depends on `x`
/// alone; a second call with the same `x` changes nothing.
void renew_ground(sim::Simulation& simulation, sim::WorldIndex world, const MovingPatch& patch,
                  const std::vector<GrainPlace>& start, double x);

}  // namespace gonogo::terrain
