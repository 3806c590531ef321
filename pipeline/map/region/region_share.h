// How much of a region lies inside the box that a design samples.
#pragma once
#include "pipeline/campaign/design/design.h"
#include "pipeline/map/region/region.h"

namespace gonogo::map {

/// Share [0, 1] of the region's cells that have a slope, driven straight uphill, whose slope and soil lie inside the
/// sampled ranges; a soil that the region knows by spreads counts by the share of its points that do. Variables that
/// the design holds fixed, and those that the region does not know, are not looked at.
double share_inside(const Region& region, const campaign::DesignSpec& spec);

}  // namespace gonogo::map
