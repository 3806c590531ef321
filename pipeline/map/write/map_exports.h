// Exports a map for other programs: polygons, an overlay for globes, a STAC catalogue entry, the speed curve.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/write/block_digest.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

/// Writes classes.gpkg, overlay.png, overlay.kml and stac.json, and speed_curve.csv if there is a speed layer. The
/// layers in `summary` must already be in the folder. Returns the paths written.
std::vector<std::filesystem::path> write_map_exports(const MapRequest& request, const terrain::MapGrid& grid,
                                                     const std::vector<MapLayer>& layers, const MapSummary& summary,
                                                     const SpeedCurve& speeds);

}  // namespace gonogo::map
