// Which shapes of a world are binned, and how many bins of what size it gets. Host only.
#pragma once
#include "sim/scene/scene.h"

namespace gonogo::sim {

/// Shapes with a bounding radius up to this one are binned [m]; 0 when the world has none to bin. Binned shapes are at
/// most four times as large as the smallest, and the few that are much larger than all others stay out, so that one box
/// does not widen the bins of a whole bed.
Real binned_radius(const SceneWorld& world, const StepSettings& settings);

bool is_binned(const Shape& s, Real binned_radius);

/// Sets bin_size and bins of `p`: no more bins than a few per binned shape, wherever the domain ends. Throws InputError
/// (naming world `w`) when a periodic side is too short for the world's spheres.
void lay_out_bins(const SceneWorld& world, const StepSettings& settings, std::size_t w, WorldParameters& p);

}  // namespace gonogo::sim
