// Shallow beds from deep ones: one settled packing serves every depth of soft soil above a hard layer.
#pragma once
#include "terrain/bed/bed.h"

namespace gonogo::terrain {

/// The packing with a hard layer `depth` [m] below its surface: grains with deeper centres are glued into the rough
/// base, and those that nothing above can touch are left out. z = 0 is the top of the hard layer. A packing that is
/// not deeper than that by half a grain stays as it is.
Packing on_hard_layer(const Packing& packing, double depth);

}  // namespace gonogo::terrain
