// Exports a map for other programs: polygons, an overlay for globes, a STAC catalogue entry, the speed curve.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/write/block_digest.h"
#include "pipeline/map/write/make_map.h"
#include "terrain/raster/globe.h"

namespace gonogo::map {

struct ExportedMap {
  const terrain::MapGrid& grid;
  const std::vector<MapLayer>& layers;
  const SpeedCurve& speeds;
  const std::optional<terrain::GlobePlace>& place;  // none: no overlay, and no geometry in stac.json
};

/// Writes classes.gpkg and stac.json; overlay.kml and its pictures if the place is known; speed_curve.csv if there is a
/// speed layer. The layers must already be in the folder. Adds the files to `summary`, and a remark if an overlay
/// cannot be made.
void write_map_exports(const MapRequest& request, const ExportedMap& map, MapSummary& summary);

/// The remark that there is no overlay.
std::string no_overlay(const std::string& because);

}  // namespace gonogo::map
