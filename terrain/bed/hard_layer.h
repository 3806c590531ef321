// Shallow beds from deep ones, so that one settled packing serves every depth of soft soil above a hard layer.
#pragma once
#include "terrain/bed/bed.h"

namespace gonogo::terrain {

/// The packing with a hard layer `depth` [m] below its surface. Grains with deeper centres become the rough base; those
/// that nothing above can touch are left out. z = 0 is the top of the hard layer. The packing is returned unchanged
/// unless it is deeper than `depth` by half a grain.
Packing on_hard_layer(const Packing& packing, double depth);

}  // namespace gonogo::terrain
