// A turning drum that mixes spheres of two materials.
#pragma once
#include "pipeline/lab/scenes/scene.h"

namespace gonogo::lab {

struct DrumSpec {
  Spheres of;
  double other_friction = 0.6;  // among spheres of the second material [-]
  double length_over_radius = 1;
  double turns = 1;      // of the drum
  double froude = 0.05;  // angular speed squared times radius over g: rolling rather than cascading
};

/// Half full, smooth caps, the rim as rough as the second material. Spheres with x < 0 are of the first material. The
/// drum turns about the y axis. Measured at the end and over the turns: mixing index of Lacey (1954) over samples of
/// about 30 spheres, 0 at the start, 1 for a random mixture.
ManyScene drum_scene(const DrumSpec& spec, const RunOn& on);

/// (v_0 - v) / (v_0 - v_r), where v is the variance of the share of the first kind over cubes of side `cube` [m]. Of
/// separated kinds it is v_0 = p (1 - p), of random samples of n spheres v_r = p (1 - p) / n. Cubes with fewer than ten
/// spheres are left out.
double lacey_index(const std::vector<Vec3d>& position, const std::vector<bool>& is_first, double cube);

}  // namespace gonogo::lab
