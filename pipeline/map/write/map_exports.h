// The map for other programs: polygons, an overlay for globes, a catalogue entry, the curve of speeds.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/write/block_digest.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

/// classes.gpkg, overlay.png, overlay.kml, stac.json and, where speeds are told, speed_curve.csv; go.tif and the other
/// layers of `summary` are in place. Returns the names written.
std::vector<std::filesystem::path> write_map_exports(const MapRequest& request, const terrain::MapGrid& grid,
                                                     const std::vector<MapLayer>& layers, const MapSummary& summary,
                                                     const SpeedCurve& speeds);

}  // namespace gonogo::map
