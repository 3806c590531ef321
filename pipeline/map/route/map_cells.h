// The cells of a region as routes need them.
#pragma once
#include "pipeline/map/evaluate/block.h"
#include "pipeline/map/route/cost.h"

namespace gonogo::map {

/// Reads the region's rasters block by block in threads: 5 bytes for each cell stay.
RouteCells read_route_cells(const MapSources& sources, const Region& region, const SoilTable& table,
                            const MapRules& rules, int threads);

}  // namespace gonogo::map
