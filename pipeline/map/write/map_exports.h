// A map for other programs and for print: polygons, an overlay for globes, a STAC catalogue entry, the speed curve, the
// figure.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/write/make_map.h"
#include "pipeline/map/write/map_tiles.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {

/// What the exports are made from.
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

/// Writes the figure to `path` as PNG.
void write_map_figure(const MapRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                      const MapSummary& summary, const Picture& picture, const std::filesystem::path& path);

}  // namespace gonogo::map
