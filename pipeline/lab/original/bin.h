// The bin of the original study: 12 by 3.5 m between walls. Grains of one size are dropped in layers onto a rough
// floor. x along the vehicle's way, y left, z up from the floor; the origin is in the middle of the floor.
//
// Numbers of test_VEH_gonogo_hmmwv.cpp (R. Serban's fork of Project Chrono, src/projects/vehicle/go_nogo, revision
// 59e928cf).
#pragma once
#include <vector>

#include "pipeline/lab/original/input.h"
#include "terrain/bed/bed.h"

namespace gonogo::lab {

struct OriginalBin {
  double half_length = 6, half_width = 1.75, half_height = 0.5;  // inside the walls [m]
  double half_wall = 0.05;                                       // half thickness of the walls [m]
  double depth = 0.1;                                            // of the bed, within the number of layers [m]
  int min_layers = 4, max_layers = 8;
  double spread = 1.01;   // of the dropped grains: their distance over that of touching ones [-]
  double base_pitch = 4;  // of the spheres of the rough floor, in grain radii [-]
};

/// Number of layers that fill the depth, within the bin's bounds.
int layer_count(const OriginalBin& bin, double radius);

/// Poisson disk sample of a rectangle about the origin: no two points are closer than `apart`, and about 30 tries
/// around each point find no free place (Bridson, "Fast Poisson disk sampling in arbitrary dimensions", SIGGRAPH 2007).
std::vector<Vec3d> poisson_disk(double half_x, double half_y, double apart, std::uint64_t seed);

/// Grains above the floor before they fall.
std::vector<Vec3d> dropped_grains(const OriginalBin& bin, double radius, std::uint64_t seed);

/// A world with the grains (bodies 0 .. n - 1) at these places and velocities, floor, and walls. Soil and floor are of
/// one material; floor, its spheres and the walls let tyres through, as in the original.
sim::SceneWorld bin_world(const OriginalBin& bin, const OriginalInput& input, double tyre_friction,
                          const std::vector<sim::BodyState>& grain);

/// Shapes of this group pass through the floor, its spheres and the walls.
inline constexpr int kPassesFloor = 1;

}  // namespace gonogo::lab
