// Share of a region that lies inside the box that a design samples.
#pragma once
#include "pipeline/campaign/design/design.h"
#include "pipeline/map/region/region.h"

namespace gonogo::map {

/// Share of the cells with a slope whose slope and soil lie inside the sampled ranges [0, 1]. The heading is uphill.
/// A soil counts with the share of its points that lie inside. Variables that the design holds fixed are ignored, and
/// so are variables that the region does not know.
double share_inside(const Region& region, const campaign::DesignSpec& spec);

}  // namespace gonogo::map
