// Ways as files: GPX tracks with heights and times, or lines with what they cost.
#pragma once
#include <vector>

#include "pipeline/map/evaluate/block.h"
#include "pipeline/map/route/find_ways.h"

namespace gonogo::map {

/// Writes `request.lines`, .gpx as tracks and waypoints, otherwise as lines; the weakest stretches are marked in both.
void write_ways(const RouteRequest& request, const MapSources& sources, const RouteCells& cells, const AllCosts& costs,
                const std::vector<FoundWay>& ways);

}  // namespace gonogo::map
