// QGIS styles inside a GeoPackage, in the table layer_styles that QGIS reads by itself ("Save Style > In Database"
// writes the same). Only for the .cpp files of this folder.
#pragma once
#include <gdal_priv.h>

#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster/geotiff.h"

namespace gonogo::terrain {

/// Colours features by the label in `column`. Polygons are filled; lines lie over a wider white line.
struct VectorStyle {
  std::string column;
  bool polygons = false;
  std::vector<LegendEntry> legend;
};

/// The style in QGIS's XML (qgis.dtd: qgis/renderer-v2 of type categorizedSymbol).
std::string qgis_style(const VectorStyle& style);

/// Makes `style` the layer's default. The geometry column is "geom", the driver's default. Throws DeviceError.
void embed_style(GDALDataset& geopackage, const std::string& layer, const VectorStyle& style,
                 const std::filesystem::path& path);

}  // namespace gonogo::terrain
