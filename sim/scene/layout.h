// Which shapes of a world are binned, and the size and number of its bins. Host only.
#pragma once
#include "sim/scene/scene.h"

namespace gonogo::sim {

/// Max bounding radius of binned shapes [m]; 0 when the world has none. It is at most four times the smallest radius,
/// and the few shapes much larger than all others stay out, so that one box does not widen the bins of a whole bed.
Real binned_radius(const SceneWorld& world, const StepSettings& settings);

bool is_binned(const Shape& s, Real binned_radius);

/// Sets bin_size and bins of `p`: at most a few bins per binned shape, for any size of the domain. Throws InputError,
/// naming world `w`, when a periodic side is too short for the world's spheres.
void lay_out_bins(const SceneWorld& world, const StepSettings& settings, std::size_t w, WorldParameters& p);

}  // namespace gonogo::sim
