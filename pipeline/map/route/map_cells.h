// Inputs of a region's cells for the route search.
#pragma once
#include "pipeline/map/evaluate/block.h"
#include "pipeline/map/route/cost.h"

namespace gonogo::map {

/// Reads the region's rasters band by band in threads. The result takes 5 bytes per cell. Throws InputError if the
/// region lists more soils than a byte can number.
RouteCells read_route_cells(const MapSources& sources, const Region& region, const SoilTable& table,
                            const MapRules& rules, int threads);

}  // namespace gonogo::map
